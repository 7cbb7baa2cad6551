"""SARAH: a biped balanced by a pattern generator whose parameters are learned."""
