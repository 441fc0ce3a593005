"""What single poses say of the noise, whatever the model of the arm lacks."""
