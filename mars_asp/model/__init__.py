"""What modules and configurations are: frozen values."""
