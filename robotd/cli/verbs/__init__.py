"""The verbs of ``robotctl``, a module for each family; only the module of the verb that was typed is imported."""
