"""Doors to other libraries: formats of ASE's files (`formats`), MDAnalysis (`mdanalysis`, `stream`, `converter`) and spglib (`symmetry`),
imported when they are used."""
