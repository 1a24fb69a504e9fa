"""Pictures as PNG files (needs the extra ``plots``)."""
