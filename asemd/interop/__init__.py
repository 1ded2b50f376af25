"""Doors to other libraries: MDAnalysis (`mdanalysis`, `stream`, `converter`) and spglib (`symmetry`), imported when they are used."""
