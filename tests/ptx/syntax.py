"""PTX text taken apart: functions with their parameters, statements, operands (PTX ISA 9.0)."""
import re
from dataclasses import dataclass

C_TYPE = {"pred": "uint8_t", "f32": "float", "f64": "double"}
BYTES = {"pred": 1, "f32": 4, "f64": 8}
for bits in (8, 16, 32, 64):
    for letter, c in (("b", "uint"), ("u", "uint"), ("s", "int")):
        C_TYPE[f"{letter}{bits}"] = f"{c}{bits}_t"
        BYTES[f"{letter}{bits}"] = bits // 8


class Unsupported(Exception):
    """PTX that this translator does not know; never guessed at."""


def is_float(ptx_type):
    return ptx_type in ("f32", "f64")


def unsigned(ptx_type):
    return f"uint{8 * BYTES[ptx_type]}_t"


def identifier(prefix, name):
    return prefix + re.sub(r"\W", "_", name)


@dataclass
class Parameter:
    name: str
    offset: int  # in the block of all parameters
    size: int


def parameters(text):
    out, offset = [], 0
    for item in (x.strip() for x in text.split(",") if x.strip()):
        m = re.match(r"\.param\s+(?:\.align\s+(\d+)\s+)?\.(\w+)\s+(?:\.ptr\s+(?:\.\w+\s+)*?\.align\s+\d+\s+)?([\w$]+)(?:\[(\d+)\])?$", item)
        if not m:
            raise Unsupported("parameter " + item)
        size = BYTES[m[2]] * int(m[4] or 1)
        align = int(m[1] or BYTES[m[2]])
        offset = (offset + align - 1) // align * align
        out.append(Parameter(m[3], offset, size))
        offset += size
    return out


@dataclass
class Function:
    name: str
    entry: bool
    parameters: list
    results: list
    attributes: str
    body: str


def closing_brace(text, start):
    depth = 1
    for m in re.compile(r"[{}]").finditer(text, start):
        depth += 1 if m[0] == "{" else -1
        if depth == 0:
            return m.start()
    raise Unsupported("a body that does not end")


def functions(text):
    """All functions with a body; what lies between them is returned too (module variables)."""
    found, outside, at = [], [], 0
    header = re.compile(r"(?:\.\w+\s+)*\.(entry|func)\s+(?:\(([^)]*)\)\s*)?([\w$]+)\s*(?:\(([^)]*)\))?([^{;]*)([{;])")
    while m := header.search(text, at):
        outside.append(text[at : m.start()])
        at = m.end()
        if m[6] == "{":
            end = closing_brace(text, at)
            found.append(Function(m[3], m[1] == "entry", parameters(m[4] or ""), parameters(m[2] or ""), " ".join(m[5].split()), text[at:end]))
            at = end + 1
    outside.append(text[at:])
    return found, "".join(outside)


def without_comments(text):
    return re.sub(r"//[^\n]*", "", re.sub(r"/\*.*?\*/", "", text, flags=re.S))


_STATEMENT = re.compile(
    r"\s*(?:(?P<brace>[{}])|(?P<table>[\w$]+):\s*\.branchtargets\s+(?P<targets>[^;]*);|(?P<label>[\w$]+):|(?P<empty>;)|(?P<text>[^;{}]+(?:\{[^{}]*\}[^;{}]*)*);)"
)


def statements(body):
    """('brace', c), ('label', name), ('table', name, [labels]) or ('text', one statement)."""
    at, body = 0, body.rstrip()
    while at < len(body):
        m = _STATEMENT.match(body, at)
        if not m:
            raise Unsupported("text " + body[at : at + 80].strip())
        at = m.end()
        if m["brace"]:
            yield "brace", m["brace"]
        elif m["table"]:
            yield "table", m["table"], [x.strip() for x in m["targets"].split(",")]
        elif m["label"]:
            yield "label", m["label"]
        elif m["text"]:
            yield "text", " ".join(m["text"].split())


def operands(text):
    """Split at the commas outside brackets."""
    out, depth, current = [], 0, ""
    for ch in text:
        depth += ch in "{[("
        depth -= ch in "}])"
        if ch == "," and depth == 0:
            out.append(current.strip())
            current = ""
        else:
            current += ch
    return out + [current.strip()] if current.strip() else out
