"""The comparison of rigs: documents of a folder, changes over time, numbers of the class, distances, and the page.

```text
documents → effects, numbers (segments, pooled) → alike → compare → record (class.json), page (class.html)
```
"""

from .compare import Across, across

__all__ = ["Across", "across"]
