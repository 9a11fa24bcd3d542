"""One PTX instruction -> one C statement. What is not known here is an error (Unsupported).

A handler gets the function being translated (`f`: f.value reads an operand as a PTX type, f.assign writes a register, f.address
forms an address) and the instruction: name, modifiers, type (the last modifier that is one), operands. Modifiers that only say how
something is cached or ordered between threads mean nothing where the threads of a launch run one after the other.
"""
import re
from types import SimpleNamespace

from syntax import BYTES, C_TYPE, Unsupported, identifier, is_float, operands, unsigned

HANDLERS = {}
ORDERING = {"volatile", "relaxed", "acquire", "release", "acq_rel", "weak", "gpu", "cta", "sys", "nc", "unified", "aligned", "sync"}


def handles(*names):
    def register(function):
        for name in names:
            HANDLERS[name] = function
        return function

    return register


def translate(f, text):
    opcode, _, rest = text.partition(" ")
    name, *modifiers = opcode.split(".")
    if name not in HANDLERS:
        raise Unsupported("opcode " + opcode)
    ptx_type = modifiers[-1] if modifiers and modifiers[-1] in C_TYPE else None
    return HANDLERS[name](f, SimpleNamespace(opcode=opcode, name=name, mods=modifiers, type=ptx_type, ops=operands(rest), rest=rest))


def only(i, *allowed):
    """The modifiers in front of the type; any that is not among `allowed` would change the meaning."""
    for m in i.mods:
        if m not in allowed and m != i.type and m not in ORDERING:
            raise Unsupported(i.opcode)


def values(f, i, ptx_type=None):
    return [f.value(x, ptx_type or i.type) for x in i.ops[1:]]


def vector(operand):
    return [x.strip() for x in operand.strip("{} ").split(",")]


# --- memory ---

CHECKS = {"global": "CHECK", "generic": "CHECK", "shared": "CHECK_SHARED", "local": "CHECK_LOCAL"}


def space_of(i):
    return next((m for m in i.mods if m in ("param", "global", "shared", "local", "const")), "generic")


def checked(i, space, size, how):
    return f"{CHECKS[space]}(A, {size}, {how}); " if space in CHECKS else ""


@handles("ld", "ldu", "st")
def load_store(f, i):
    only(i, "param", "global", "shared", "local", "const", "v2", "v4")
    store, space = i.name == "st", space_of(i)
    width = next((int(m[1]) for m in i.mods if m in ("v2", "v4")), 1)
    place, register = (i.ops[0], i.ops[1]) if store else (i.ops[1], i.ops[0])
    size, registers = BYTES[i.type], vector(register)
    if len(registers) != width:
        raise Unsupported(i.opcode)
    out = f"{{ const uint64_t A = {f.address(place, space)}; " + checked(i, space, size * width, "WRITES" if store else "READS")
    for k, r in enumerate(registers):
        cell = f"*({C_TYPE[i.type]}*)(A + {k * size})"
        out += f"{cell} = {f.value(r, i.type)}; " if store else f.assign(r, i.type, cell) + " "
    return out + "}"


@handles("mov")
def mov(f, i):
    to, source = i.ops
    bits = 8 * BYTES[i.type]
    if to.startswith("{"):  # unpack
        parts = vector(to)
        w = bits // len(parts)
        return f"{{ const uint64_t X = {f.value(source, f'b{bits}')}; " + " ".join(f.assign(r, f"b{w}", f"(uint{w}_t)(X >> {k * w})") for k, r in enumerate(parts)) + " }"
    if source.startswith("{"):  # pack
        parts = vector(source)
        w = bits // len(parts)
        return f.assign(to, f"b{bits}", f"({unsigned(i.type)})(" + " | ".join(f"(uint64_t){f.value(r, f'b{w}')} << {k * w}" for k, r in enumerate(parts)) + ")")
    return f.assign(to, i.type, f.value(source, i.type))


@handles("cvta")
def cvta(f, i):
    v = f.value(i.ops[1], "u64")
    if "shared" in i.mods:
        v = f"{v} {'-' if 'to' in i.mods else '+'} (uint64_t)t->shared"
    return f.assign(i.ops[0], "u64", v)


@handles("atom", "red")
def atomic(f, i):
    only(i, "global", "shared", "add", "exch", "cas", "min", "max", "and", "or", "xor")
    ops = i.ops if i.name == "atom" else ["_"] + i.ops
    what = next(m for m in i.mods if m in ("add", "exch", "cas", "min", "max", "and", "or", "xor"))
    space, c, x = space_of(i), C_TYPE[i.type], f.value(ops[2], i.type)
    new = {"add": f"O + {x}", "exch": x, "min": f"O < {x} ? O : {x}", "max": f"O > {x} ? O : {x}", "and": f"O & {x}", "or": f"O | {x}", "xor": f"O ^ {x}"}.get(what)
    if what == "cas":
        new = f"O == {x} ? {f.value(ops[3], i.type)} : O"
    return (
        f"{{ const uint64_t A = {f.address(ops[1], space)}; {checked(i, space, BYTES[i.type], 'SHARES')}"
        f"const {c} O = *({c}*)A; *({c}*)A = ({c})({new}); {f.assign(ops[0], i.type, 'O')} }}"
    )


@handles("membar", "fence", "prefetch", "prefetchu")
def ordering(f, i):
    return ";"


# --- arithmetic ---


@handles("add", "sub", "mul", "mad", "addc", "subc", "madc")
def arithmetic(f, i):
    if "cc" in i.mods or i.name.endswith("c"):
        return with_carry(f, i)
    sign = {"add": "+", "sub": "-", "mul": "*"}.get(i.name)
    if is_float(i.type):
        only(i, "rn")
        if "rn" not in i.mods:  # ptxas may fuse it: results would depend on it
            raise Unsupported(i.opcode + " without .rn (compile with --fmad=false)")
        x, y = values(f, i)
        return f.assign(i.ops[0], i.type, f"{x} {sign} {y}")
    if i.name in ("add", "sub"):
        only(i)
        x, y = values(f, i, "b" + i.type[1:])
        return f.assign(i.ops[0], i.type, f"({C_TYPE[i.type]})({x} {sign} {y})")
    only(i, "lo", "hi", "wide")
    x, y, bits = f.value(i.ops[1], i.type), f.value(i.ops[2], i.type), 8 * BYTES[i.type]
    result = i.type[0] + str(2 * bits if "wide" in i.mods else bits)
    wide = ("__int128" if i.type[0] == "s" else "unsigned __int128") if bits == 64 else f"{'' if i.type[0] == 's' else 'u'}int64_t"
    e = f"(({wide}){x} * ({wide}){y})"
    if "hi" in i.mods:
        e = f"({e} >> {bits})"
    if i.name == "mad":
        e = f"({unsigned(result)}){e} + ({unsigned(result)}){f.value(i.ops[3], result)}"
    return f.assign(i.ops[0], result, f"({C_TYPE[result]})({e})")


def with_carry(f, i):
    """Chains of 32-bit words; the carry is a flag of the thread."""
    only(i, "cc", "lo", "hi")
    if BYTES[i.type] != 4:
        raise Unsupported(i.opcode)
    x, y = f.value(i.ops[1], "u32"), f.value(i.ops[2], "u32")
    carry = "carry" if i.name.endswith("c") else "0"
    if i.name.startswith("mad"):
        c = "int64_t" if i.type[0] == "s" else "uint64_t"
        product = f"(({c}){f.value(i.ops[1], i.type)} * ({c}){f.value(i.ops[2], i.type)})"
        e = f"(uint64_t)(uint32_t)({product}{' >> 32' if 'hi' in i.mods else ''}) + {f.value(i.ops[3], 'u32')} + {carry}"
    else:
        s = "+" if i.name.startswith("add") else "-"
        e = f"(uint64_t){x} {s} {y} {s} {carry}"
    return f"{{ const uint64_t X = {e}; {f.assign(i.ops[0], 'b32', '(uint32_t)X')} {'carry = (X >> 32) & 1; ' if 'cc' in i.mods else ''}}}"


@handles("fma")
def fma(f, i):
    only(i, "rn")
    return f.assign(i.ops[0], i.type, f"__builtin_fma{'f' if i.type == 'f32' else ''}({', '.join(values(f, i))})")


@handles("div", "rem")
def divide(f, i):
    x, y = values(f, i)
    if is_float(i.type):
        if "rn" not in i.mods:
            raise Unsupported(i.opcode)
        return f.assign(i.ops[0], i.type, f"{x} / {y}")
    return f.assign(i.ops[0], i.type, f"{i.name}_{i.type}({x}, {y})")


@handles("sqrt", "rcp", "rsqrt")
def roots(f, i):
    x = f.value(i.ops[1], i.type)
    if "rn" in i.mods and i.name != "rsqrt":
        only(i, "rn")
        return f.assign(i.ops[0], i.type, f"1 / {x}" if i.name == "rcp" else f"__builtin_sqrt{'f' if i.type == 'f32' else ''}({x})")
    if i.opcode in ("rcp.approx.ftz.f64", "rsqrt.approx.f64", "rsqrt.approx.ftz.f64"):  # start of a Newton iteration: the upper word only
        return f.assign(i.ops[0], i.type, f"upper_word({'1 / ' + x if i.name == 'rcp' else f'1 / __builtin_sqrt({x})'})")
    raise Unsupported(i.opcode)


@handles("neg", "abs", "not", "cnot")
def unary(f, i):
    only(i)
    x, suffix = f.value(i.ops[1], i.type), "f" if i.type == "f32" else ""
    e = {
        "neg": f"-{x}" if is_float(i.type) else f"(0 - ({unsigned(i.type)}){x})",
        "abs": f"__builtin_fabs{suffix}({x})" if is_float(i.type) else f"({x} < 0 ? 0 - ({unsigned(i.type)}){x} : ({unsigned(i.type)}){x})",
        "not": f"!{x}" if i.type == "pred" else f"~{x}",
        "cnot": f"!{x}",
    }[i.name]
    return f.assign(i.ops[0], i.type, f"({C_TYPE[i.type]})({e})")


@handles("min", "max")
def least(f, i):
    only(i)
    x, y = values(f, i)
    if is_float(i.type):  # a NaN loses, -0 < +0
        return f.assign(i.ops[0], i.type, f"({C_TYPE[i.type]}){i.name}_float({x}, {y})")
    return f.assign(i.ops[0], i.type, f"({x} {'<' if i.name == 'min' else '>'} {y} ? {x} : {y})")


@handles("copysign")
def copysign(f, i):
    sign, magnitude = values(f, i)
    return f.assign(i.ops[0], i.type, f"__builtin_copysign{'f' if i.type == 'f32' else ''}({magnitude}, {sign})")


@handles("testp")
def testp(f, i):
    x = f.value(i.ops[1], i.type)
    e = {"notanumber": f"{x} != {x}", "number": f"{x} == {x}", "finite": f"{x} - {x} == 0", "infinite": f"({x} == {x} && {x} - {x} != 0)"}[i.mods[0]]
    return f.assign(i.ops[0], "pred", f"({e})")


# --- bits ---


@handles("and", "or", "xor")
def logic(f, i):
    x, y = values(f, i)
    return f.assign(i.ops[0], i.type, f"{x} {dict(zip(('and', 'or', 'xor'), '&|^'))[i.name]} {y}")


@handles("shl", "shr")
def shift(f, i):
    x, n, bits = f.value(i.ops[1], i.type), f.value(i.ops[2], "u32"), 8 * BYTES[i.type]
    if i.type[0] == "s":
        e = f"{x} >> ({n} >= {bits} ? {bits - 1} : {n})"
    else:
        e = f"{n} >= {bits} ? 0 : (uint64_t){x} {'<<' if i.name == 'shl' else '>>'} {n}"
    return f.assign(i.ops[0], i.type, f"({C_TYPE[i.type]})({e})")


@handles("shf")
def funnel(f, i):
    low, high, n = (f.value(x, "u32") for x in i.ops[1:])
    n = f"({n} & 31)" if "wrap" in i.mods else f"({n} > 32 ? 32 : {n})"
    both = f"((uint64_t){high} << 32 | {low})"
    return f.assign(i.ops[0], "b32", f"(uint32_t)({both} >> {n})" if i.mods[0] == "r" else f"(uint32_t)(({both} << {n}) >> 32)")


@handles("popc", "clz")
def counts(f, i):
    return f.assign(i.ops[0], "u32", f"{i.name}{8 * BYTES[i.type]}({f.value(i.ops[1], i.type)})")


@handles("brev")
def brev(f, i):
    return f.assign(i.ops[0], i.type, f"brev{8 * BYTES[i.type]}({f.value(i.ops[1], i.type)})")


@handles("bfe", "bfi")
def bit_field(f, i):
    fields = i.ops[1:-2]
    args = [f.value(x, i.type) for x in fields] + [f.value(x, "u32") for x in i.ops[-2:]]
    if i.type not in ("u32", "u64", "b32", "b64"):
        raise Unsupported(i.opcode)
    return f.assign(i.ops[0], i.type, f"{i.name}{8 * BYTES[i.type]}({', '.join(args)})")


@handles("prmt", "lop3")
def words(f, i):
    if i.mods != ["b32"]:
        raise Unsupported(i.opcode)
    return f.assign(i.ops[0], "b32", f"{i.name}({', '.join(values(f, i, 'u32'))})")


# --- comparison, selection, conversion ---

COMPARE = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">=", "lo": "<", "ls": "<=", "hi": ">", "hs": ">="}
OPPOSITE = {"lt": ">=", "le": ">", "gt": "<=", "ge": "<"}


def comparison(f, i):
    c, (x, y) = i.mods[0], (f.value(i.ops[1], i.type), f.value(i.ops[2], i.type))
    if not is_float(i.type):
        return f"{x} {COMPARE[c]} {y}"
    if c in ("num", "nan"):
        return f"({x} == {x} && {y} == {y})" if c == "num" else f"({x} != {x} || {y} != {y})"
    if c == "ne":  # ordered: false with a NaN
        return f"({x} < {y} || {x} > {y})"
    if c in COMPARE:
        return f"{x} {COMPARE[c]} {y}"
    if c in ("equ", "neu"):  # unordered: true with a NaN
        return f"{x} != {y}" if c == "neu" else f"!({x} < {y} || {x} > {y})"
    return f"!({x} {OPPOSITE[c[:2]]} {y})"


@handles("setp")
def setp(f, i):
    combine = next((m for m in i.mods[1:-1] if m in ("and", "or", "xor")), None)
    if len(i.mods) != (3 if combine else 2):
        raise Unsupported(i.opcode)
    e = f"({comparison(f, i)})"
    to = [x.strip() for x in i.ops[0].split("|")]
    q = f.value(i.ops[3], "pred") if combine else None
    join = lambda x: f"({x} {dict(zip(('and', 'or', 'xor'), '&|^'))[combine]} {q})" if combine else x
    if len(to) == 1:
        return f.assign(to[0], "pred", join(e))
    return f"{{ const uint8_t X = {join(e)}, Y = {join('!' + e)}; {f.assign(to[0], 'pred', 'X')} {f.assign(to[1], 'pred', 'Y')} }}"


@handles("selp")
def selp(f, i):
    return f.assign(i.ops[0], i.type, f"({f.value(i.ops[3], 'pred')} ? {f.value(i.ops[1], i.type)} : {f.value(i.ops[2], i.type)})")


ROUND = {"rni": "rint", "rzi": "trunc", "rmi": "floor", "rpi": "ceil"}


@handles("cvt")
def cvt(f, i):
    *how, to, source = i.mods
    x = f.value(i.ops[1], source)
    rounding = next((m for m in how if m in ROUND), None)
    if set(how) - set(ROUND) - {"rn", "sat"}:
        raise Unsupported(i.opcode)
    if rounding:
        x = f"__builtin_{ROUND[rounding]}{'f' if source == 'f32' else ''}({x})"
    if is_float(source) and is_float(to):
        x = f"({C_TYPE[to]}){x}"
        return f.assign(i.ops[0], to, f"({C_TYPE[to]})saturate({x})" if "sat" in how else x)
    if "sat" in how or is_float(source) and not rounding:
        raise Unsupported(i.opcode)
    return f.assign(i.ops[0], to, f"to_{to}({x})" if is_float(source) else f"({C_TYPE[to]}){x}")


# --- control ---


@handles("bra")
def bra(f, i):
    return f"goto {identifier('L', i.ops[0])};"


@handles("brx")
def brx(f, i):
    return f.jump_table(f.value(i.ops[0], "u32"), i.ops[1])


@handles("ret", "exit")
def ret(f, i):
    if i.name == "exit" and not f.entry:
        raise Unsupported("exit outside a kernel")
    return "return;"


@handles("trap", "brkpt")
def trap(f, i):
    return "ptx_trap(t);"


@handles("call")
def call(f, i):
    m = re.match(r"(?:\(([^)]*)\)\s*,\s*)?([\w$]+)\s*(?:,\s*\(([^)]*)\))?$", i.rest)
    if not m:
        raise Unsupported("call " + i.rest)
    names = [x.strip() for x in ((m[1] or "") + "," + (m[3] or "")).split(",") if x.strip()]
    f.calls.add(m[2])
    return f"{identifier('F', m[2])}({', '.join(['t'] + [f.array(n) for n in names])});"


# --- threads together: kernels with these run as fibers (threads.cpp) ---


@handles("bar", "barrier")
def barrier(f, i):
    f.meets = True
    if i.mods[0] == "warp":
        return f"ptx_warp_sync(t, {f.value(i.ops[0], 'u32')});"
    number = i.ops[1] if "red" in i.mods else i.ops[0]
    if number != "0" or len(i.ops) != (3 if "red" in i.mods else 1):
        raise Unsupported("a barrier of some threads of a block")
    if "red" not in i.mods:
        return "ptx_barrier(t, 0);"
    e = f"ptx_barrier(t, {f.value(i.ops[2], 'pred')})"
    e, to = {"popc": (e, "u32"), "or": (f"{e} != 0", "pred"), "and": (f"{e} == ptx_block_threads(t)", "pred")}[next(m for m in i.mods if m in ("popc", "or", "and"))]
    return f.assign(i.ops[0], to, e)


@handles("vote")
def vote(f, i):
    f.meets = True
    kind = next(m for m in i.mods if m in ("all", "any", "uni", "ballot"))
    e = f"ptx_vote_{kind}(t, {f.value(i.ops[1], 'pred')}, {f.value(i.ops[2], 'u32')})"
    return f.assign(i.ops[0], "b32" if kind == "ballot" else "pred", e)


@handles("shfl")
def shfl(f, i):
    f.meets = True
    kind = next(m for m in i.mods if m in ("up", "down", "bfly", "idx"))
    to = [x.strip() for x in i.ops[0].split("|")]
    args = ", ".join([f.value(i.ops[1], "b32")] + [f.value(x, "u32") for x in i.ops[2:5]])
    out = f"{{ uint8_t P; const uint32_t X = ptx_shfl(t, SHFL_{kind.upper()}, {args}, &P); {f.assign(to[0], 'b32', 'X')} "
    return out + (f.assign(to[1], "pred", "P") + " }" if len(to) > 1 else "}")


@handles("match")
def match(f, i):
    f.meets = True
    if i.mods[0] != "any":
        raise Unsupported(i.opcode)
    return f.assign(i.ops[0], "b32", f"ptx_match_any(t, {f.value(i.ops[1], i.type)}, {f.value(i.ops[2], 'u32')})")


@handles("nanosleep")
def nanosleep(f, i):
    f.meets = True
    return "ptx_wait(t);"
