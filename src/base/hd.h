#pragma once
// MORTISE_HD marks functions and lambdas that run inside kernels on either device.
#ifdef __CUDACC__
#define MORTISE_HD __host__ __device__
#else
#define MORTISE_HD
#endif
