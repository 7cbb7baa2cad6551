"""NAF as a contribution to other packages, made from what is here."""
