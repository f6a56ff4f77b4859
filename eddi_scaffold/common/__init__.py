"""What every room stands on: problems and their places, files, identifiers, units, graphs."""
