"""A program that fills a store: evidence_writer.py STORE FIRST COUNT. Says a line after each instance."""

from __future__ import annotations

import sys

from selector.evidence.store import Store
from tests.selector.evidence_rows import filled

if __name__ == "__main__":
    path, first, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    with Store.open(path) as store:
        for index in range(first, first + count):
            filled(store, 1, index)
            sys.stdout.write(f"{index}\n")
            sys.stdout.flush()
