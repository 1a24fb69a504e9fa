"""Mapping and localizing at once: stops are the truth, maps are made of them again and again.

Pure: states and sweeps in, states and decisions out (:mod:`.survey`). What a sweep says of its place is told by
:mod:`robotd.localization.placing`; what all of them say together by the graph of stops (:mod:`.graph`, :mod:`.solve`).
"""
