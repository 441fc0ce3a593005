"""What a fit of positions learns of the noise, and of the error of the model beside it."""
