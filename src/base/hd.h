#pragma once
// MORTISE_HD marks functions and lambdas that run inside kernels on either device.
// MORTISE_ROLLED before a loop: it stays one in kernels. Unrolled bodies of long loops need registers, and fewer threads then fit.
#ifdef __CUDACC__
#define MORTISE_HD __host__ __device__
#else
#define MORTISE_HD
#endif
#ifdef __CUDA_ARCH__
#define MORTISE_ROLLED _Pragma("unroll 1")
#else
#define MORTISE_ROLLED
#endif
