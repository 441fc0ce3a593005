"""One format a file, and the catalogue of them; containers of tables beside them."""
