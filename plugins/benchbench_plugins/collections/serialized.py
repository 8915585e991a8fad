"""What a serialised CasADi function would do when it is read: judged from its text, before CasADi sees it.

Reading one is running one: an external function loads its library, a just-in-time one starts the compiler that it names.
CasADi writes every function as its class's name, a version, then its fields; a string as its length and its characters; and each
byte as two letters, the low half first.
"""

from __future__ import annotations

import re

PLAIN = ("SXFunction", "MXFunction", "Map", "MapSum", "Switch", "Interpolant")
"""Classes that evaluate expressions and do nothing else."""
OTHERS = ("External", "FmuFunction", "DllLibrary", "Nlpsol", "Rootfinder", "Integrator", "Conic", "Callback")
"""Classes that load libraries, or solve and may write files."""
_LIKE_A_CLASS = re.compile(rb"[A-Z]\w*(?:Function|External|Library|Importer|Callback|Compiler)")
_JIT = re.compile(rb"(.).(?:\x06\0\0\0(source)|\x04\0\0\0link|\x05\0\0\0embed)", re.DOTALL)


def foreign(text: str) -> str:
    """Return what a serialised function does beside evaluating expressions, empty where it does nothing else.

    Raises ValueError for a text that no CasADi function is written as.
    """
    data = _bytes(text)
    found = {name.decode() for name in _names(data)}
    if not found & set(PLAIN) and not found & set(OTHERS):
        raise ValueError("it is no serialised CasADi function")
    if others := sorted(found - set(PLAIN)):
        return f"contains a function of the class {', '.join(others)}"
    ways = [(jit[1] != b"\0", jit[2] is None) for jit in _JIT.finditer(data)]
    made = sum(data.count(b"\n\0\0\0" + name) for name in (b"SXFunction", b"MXFunction"))
    if len(ways) < made or any(on or carried for on, carried in ways):
        return "is compiled when it is read"
    return ""


def _bytes(text: str) -> bytes:
    letters = text.encode("ascii", "replace")
    if len(letters) % 2 or not re.fullmatch(rb"[a-p]+", letters):
        raise ValueError("it is no serialised CasADi function")
    return bytes((low - 97) | (high - 97) << 4 for low, high in zip(letters[::2], letters[1::2], strict=True))


def _names(data: bytes) -> set[bytes]:
    """Names of classes that stand in the stream as strings: the known ones, and what looks like one."""
    known = {name.encode() for name in (*PLAIN, *OTHERS)}
    candidates = known | {match[0] for match in _LIKE_A_CLASS.finditer(data)}
    return {name for name in candidates if len(name).to_bytes(4, "little") + name in data}
