#!/usr/bin/env python3
"""translate_test.py BUILD: what the translator refuses, and that test_ptx tries every opcode that the module has."""
import sys
import unittest
from pathlib import Path

from instructions import HANDLERS
from syntax import Unsupported
from translate import Module

BUILD = Path(sys.argv.pop(1)) / "tests/ptx"


def kernel(body, registers=".reg .f64 %fd<4>; .reg .b32 %r<4>; .reg .b64 %rd<4>; .reg .pred %p<4>;"):
    return Module(f".target sm_90 .visible .entry k(.param .u64 k_param_0) {{ {registers} {body} ret; }}").c()


def opcodes(folder):
    return {o for path in (BUILD / folder).glob("*.c") for o in path.read_text().split("\n", 1)[0].replace("// opcodes:", "").split() if not o.startswith("#")}


class Translator(unittest.TestCase):
    def test_what_it_knows(self):
        self.assertIn("v_r2 + v_r3", kernel("add.s32 %r1, %r2, %r3;"))

    def test_what_it_refuses(self):
        for body in (
            "frobnicate.s32 %r1, %r2;",  # no such instruction
            "add.f64 %fd1, %fd2, %fd3;",  # may be fused
            "mul.rz.f64 %fd1, %fd2, %fd3;",  # another rounding
            "sqrt.approx.f32 %r1, %r2;",
            "mov.u32 %r1, %clock;",  # no such register here
            "bar.sync 1, 64;",  # some threads of a block
            "ld.global.u32 %r1, [nowhere];",
            "cvt.rz.f64.s64 %fd1, %rd1;",
            "call (retval0), %rd1, (param0);",  # through a pointer
        ):
            with self.assertRaises((Unsupported, KeyError), msg=body):
                kernel(body)

    def test_every_opcode_of_the_module_is_tested(self):
        self.assertGreater(len(opcodes("ptx_kernels")), 30)
        self.assertEqual(opcodes("ptx_kernels") - opcodes("ptx_test"), set())

    def test_every_handler_is_tested(self):
        self.assertEqual(set(HANDLERS) - opcodes("ptx_test") - UNTESTED, set())


# Forms that nvcc 13 did not make of anything here.
UNTESTED = {"barrier", "ldu", "brx", "trap", "brkpt", "prefetch", "prefetchu", "fence", "membar", "red"}

if __name__ == "__main__":
    unittest.main()
