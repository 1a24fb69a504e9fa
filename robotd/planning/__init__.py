"""How to get there: grown obstacles, flood-fill distance, descent, legs."""
