"""Array work: jobs that are data, and the maps and stops they are about, held by number where the work is done."""
