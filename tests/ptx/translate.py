#!/usr/bin/env python3
"""PTX -> C: every kernel becomes a C function that is called once per thread (machine.h).

  translate.py --cuobjdump PATH OBJECT OUT.c    the PTX in an object file that nvcc made
  translate.py FILE.ptx OUT.c

Exit code 1, with the opcode, when there is something that this translator does not know.
"""
import argparse
import re
import subprocess
import sys
from pathlib import Path

import instructions
from syntax import BYTES, C_TYPE, Unsupported, functions, identifier, is_float, operands, statements, unsigned, without_comments

THREAD = {f"%{name}.{axis}": f"t->{name}[{k}]" for name in ("tid", "ntid", "ctaid", "nctaid") for k, axis in enumerate("xyz")}
THREAD |= {
    "%laneid": "t->lane", "%warpid": "(t->linear >> 5)", "WARP_SZ": "32u", "%lanemask_eq": "(1u << t->lane)", "%lanemask_lt": "((1u << t->lane) - 1)",
    "%lanemask_le": "(~0u >> (31 - t->lane))", "%lanemask_gt": "~(~0u >> (31 - t->lane))", "%lanemask_ge": "~((1u << t->lane) - 1)",
}  # fmt: skip
REGISTER = {"s": "b", "u": "b"}  # registers hold bits; what they mean is said by the instruction


class Body:
    """Translates one function."""

    def __init__(self, module, function):
        self.module, self.function, self.entry = module, function, function.entry
        self.registers, self.symbols = [{}], [{}]  # by scope
        self.declared, self.lines, self.arrays, self.tables = [], [], [], {}
        self.shared, self.meets, self.calls = 0, False, set()
        for p in function.parameters + function.results:
            c = f"(P + {p.offset})" if self.entry else identifier("V", p.name)
            self.symbols[0][p.name] = (c, f"(uint64_t){c}")

    @staticmethod
    def find(scopes, name):
        return next((s[name] for s in reversed(scopes) if name in s), None)

    def symbol(self, name):
        found = self.find(self.symbols, name) or self.module.symbols.get(name)
        if not found and name in self.module.shared:  # written outside of the kernel that has it
            self.share(self.symbols[0], name, *self.module.shared[name])
            found = self.symbols[0][name]
        return found

    def share(self, symbols, name, size, align):
        self.shared = (self.shared + align - 1) // align * align
        symbols[name] = (None, f"(uint64_t){self.shared}")
        self.shared += size

    def array(self, name):
        return self.symbol(name)[0]

    def value(self, operand, ptx_type):
        """C expression of an operand read as `ptx_type`."""
        c = C_TYPE[ptx_type]
        if operand.startswith("!"):
            return "!" + self.value(operand[1:].strip(), "pred")
        if operand in THREAD:
            return f"(({c}){THREAD[operand]})"
        held = self.find(self.registers, operand)
        if held:
            name = identifier("v", operand)
            if C_TYPE[held] == c:
                return name
            if is_float(held) and is_float(ptx_type):
                raise Unsupported(f"{operand} ({held}) read as {ptx_type}")
            if is_float(ptx_type):
                return f"{ptx_type}_of({name})"
            return f"(({c})bits_of_{held}({name}))" if is_float(held) else f"(({c}){name})"
        if m := re.fullmatch(r"0[dDfF]([0-9a-fA-F]{8}|[0-9a-fA-F]{16})", operand):
            return f"{ptx_type}_of(0x{m[1]}ull)" if is_float(ptx_type) else f"(({c})0x{m[1]}ull)"
        if m := re.fullmatch(r"(-?)(0x[0-9a-fA-F]+|\d+)U?", operand):
            return f"(({c}){m[1]}{m[2]}ull)"
        if (m := re.fullmatch(r"([\w$]+)([+-]\d+)?", operand)) and self.symbol(m[1]):
            return f"(({c})({self.symbol(m[1])[1]}{m[2] or ''}))"
        raise Unsupported(f"operand {operand} as {ptx_type}")

    def assign(self, to, ptx_type, expression):
        """C statement that writes an expression of type `ptx_type` into a register."""
        if to == "_":
            return f"(void)({expression});"
        held = self.find(self.registers, to)
        if not held:
            raise Unsupported("result " + to)
        if C_TYPE[held] == C_TYPE[ptx_type]:
            pass
        elif is_float(held) and is_float(ptx_type):
            raise Unsupported(f"{to} ({held}) written as {ptx_type}")
        elif is_float(ptx_type):
            expression = f"bits_of_{ptx_type}({expression})"
        elif is_float(held):
            expression = f"{held}_of({expression})"
        else:  # wider registers take the sign, or zeros
            expression = f"({C_TYPE[held]})({C_TYPE[ptx_type]})({expression})"
        return f"{identifier('v', to)} = {expression};"

    def address(self, operand, space):
        m = re.fullmatch(r"\[\s*([%\w$]+)\s*(?:\+\s*(-?\d+))?\s*\]", operand)
        if not m:
            raise Unsupported("address " + operand)
        held, offset = self.find(self.registers, m[1]), int(m[2] or 0)
        if held:
            base = self.value(m[1], unsigned(held).replace("uint", "u").replace("_t", ""))
        elif self.symbol(m[1]):
            base = self.symbol(m[1])[1]
        else:
            raise Unsupported("symbol " + m[1])
        if space == "shared":  # addresses in the block's own window
            return f"((uint64_t)t->shared + (uint32_t)({base} + {offset}))"
        return f"((uint64_t){base} + {offset})" if offset >= 0 else f"((uint64_t){base} - {-offset})"

    def jump_table(self, index, table):
        return ("jump", index, table)  # the table may be defined behind the jump

    def declare(self, text):
        if m := re.match(r"\.reg\s+\.(\w+)\s+(.*)", text, re.S):
            held = m[1] if m[1] in ("pred", "f32", "f64") else "b" + m[1][1:]
            for name in operands(m[2]):
                k = re.fullmatch(r"([%\w$]+)<(\d+)>", name)
                names = [k[1] + str(n) for n in range(int(k[2]))] if k else [name]
                self.registers[-1] |= dict.fromkeys(names, held)
                variables = f"{C_TYPE[held]} {', '.join(identifier('v', n) for n in names)};" if names else ""
                (self.declared if len(self.registers) == 1 else self.lines).append(variables)
        elif m := re.match(r"\.(local|shared|param)\s+(?:\.align\s+(\d+)\s+)?\.(\w+)\s+([\w$]+)(?:\[(\d*)\])?", text):
            size, align = BYTES[m[3]] * int(m[5] or 1), int(m[2] or BYTES[m[3]])
            if m[1] == "shared":
                self.share(self.symbols[-1], m[4], size, align)
                return
            c = identifier("V", m[4])
            self.symbols[-1][m[4]] = (c, f"(uint64_t){c}")
            array = f"_Alignas({max(align, 8)}) uint8_t {c}[{size}];"
            if m[1] == "local":
                self.arrays += [array, f"UNWRITTEN({c});"]
            else:
                self.lines.append(array)
        elif not text.startswith((".pragma", ".loc", ".file")):
            raise Unsupported("directive " + text[:60])

    def statement(self, text):
        if text.startswith("."):
            return self.declare(text)
        guard = ""
        if m := re.match(r"@(!?)([%\w$]+)\s+(.*)$", text):
            guard, text = f"if ({m[1]}{self.value(m[2], 'pred')}) ", m[3]
        self.module.opcodes.add(re.match(r"\w+", text)[0])
        c = instructions.translate(self, text)
        self.lines.append((guard, *c[1:]) if isinstance(c, tuple) else f"{guard}{{ {c} }}" if guard else c)

    def translate(self):
        for kind, *what in statements(self.function.body):
            if kind == "text":
                self.statement(what[0])
            elif kind == "label":
                self.lines.append(identifier("L", what[0]) + ":;")
            elif kind == "table":
                self.tables[what[0]] = what[1]
            else:
                self.lines.append(what[0])
                for scopes in (self.registers, self.symbols):
                    scopes.append({}) if what[0] == "{" else scopes.pop()
        jump = lambda guard, index, table: f"{guard}switch ({index}) {{ {' '.join(f'case {k}: goto ' + identifier('L', l) + ';' for k, l in enumerate(self.tables[table]))} default: ptx_trap(t); }}"
        lines = [jump(*l) if isinstance(l, tuple) else l for l in self.lines]
        self.code = "\n  ".join(["uint32_t carry = 0;", *self.declared, *self.arrays, *lines, "return;"])
        return self

    def signature(self):
        if self.entry:
            return f"static void {identifier('F', self.function.name)}(Thread* t, uint8_t* P)"
        arrays = [p.name for p in self.function.results + self.function.parameters]
        return f"static void {identifier('F', self.function.name)}({', '.join(['Thread* t'] + ['uint8_t* ' + identifier('V', a) for a in arrays])})"


class Module:
    def __init__(self, text):
        text = without_comments(text)
        self.symbols, self.shared, self.globals, self.opcodes = {}, {}, [], set()  # shared: size and alignment of variables of kernels
        self.architecture = int(m[1]) if (m := re.search(r"\.target\s+sm_(\d+)", text)) else 0
        found, outside = functions(text)
        self.variables(outside)
        self.bodies = [Body(self, f).translate() for f in found]

    def variables(self, text):
        for m in re.finditer(r"\.(global|const|shared)\s+(?:\.align\s+(\d+)\s+)?\.(\w+)\s+([\w$]+)((?:\[\d*\])*)\s*(?:=\s*(\{[^}]*\}|[^;]+))?;", text):
            space, align, held, name, dimensions, start = m.groups()
            size = 1
            for n in re.findall(r"\[(\d+)\]", dimensions):
                size *= int(n)
            if space == "shared":
                if dimensions == "[]":
                    self.symbols[name] = (None, "(uint64_t)t->kernel->shared_bytes")  # dynamic: behind the kernel's own
                else:
                    self.shared[name] = (size * BYTES[held], int(align or BYTES[held]))
                continue
            numbers = [re.sub(r"^0[dDfF]", "0x", x.strip()) for x in start.strip("{} \n").split(",")] if start else []
            if any(re.match(r"[A-Za-z_$]", x) for x in numbers):
                raise Unsupported("an address as start value of " + name)
            c = identifier("G", name)
            self.globals.append(f"TABLE static {unsigned(held)} {c}[{size}]{' = {' + ', '.join(numbers) + '}' if numbers else ''};")
            self.symbols[name] = (c, f"(uint64_t){c}")

    def meets(self, body, seen=frozenset()):
        others = {b.function.name: b for b in self.bodies}
        return body.meets or any(self.meets(others[c], seen | {c}) for c in body.calls if c in others and c not in seen)

    def c(self):
        kernels = []
        for b in (b for b in self.bodies if b.entry):
            limit = re.search(r"\.maxntid\s+(\d+)", b.function.attributes)
            ps = b.function.parameters
            places = ", ".join(f"{{{p.offset}, {p.size}}}" for p in ps) or "{0, 0}"
            kernels.append(f'{{"{b.function.name}", {identifier("F", b.function.name)}, {int(self.meets(b))}, {(b.shared + 15) // 16 * 16}, {limit[1] if limit else 1024}, {self.architecture}, {len(ps)}, {{{places}}}}}')
        lines = ["// opcodes: " + " ".join(sorted(self.opcodes)), '#include "machine.h"', *self.globals, *(b.signature() + ";" for b in self.bodies)]
        lines += [f"{b.signature()} {{\n  {b.code}\n}}" for b in self.bodies]
        if kernels:
            table = ",\n".join(kernels)
            lines += [f"static const Kernel kernels[] = {{{table}}};", f"__attribute__((constructor)) static void known(void) {{ ptx_know(kernels, {len(kernels)}); }}"]
        return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cuobjdump")
    parser.add_argument("source")
    parser.add_argument("out", type=Path)
    a = parser.parse_args()
    if a.cuobjdump:
        text = subprocess.run([a.cuobjdump, "-ptx", a.source], capture_output=True, text=True, check=True).stdout
    else:
        text = Path(a.source).read_text()
    texts = text.split(".version")[1:]
    if len(texts) > 1:
        sys.exit(f"{a.source}: PTX of more than one architecture; build for one")
    try:
        a.out.write_text(Module(texts[0]).c() if texts else '#include "machine.h"\n')
    except Unsupported as e:
        sys.exit(f"{a.source}: PTX that tests/ptx does not know: {e}")


if __name__ == "__main__":
    main()
