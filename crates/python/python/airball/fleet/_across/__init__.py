"""The comparison of rigs: documents of a folder, changes over time, numbers of the class, distances, and the page."""
