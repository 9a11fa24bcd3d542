# Finds nvcc and makes CUDA a language of the project, unless MORTISE_CUDA says otherwise; MORTISE_HAS_CUDA tells how it went.
set(MORTISE_HAS_CUDA FALSE)
if(MORTISE_CUDA STREQUAL "OFF")
  return()
endif()
find_program(MORTISE_NVCC nvcc HINTS $ENV{CUDACXX} /usr/local/cuda/bin)
if(NOT MORTISE_NVCC)
  if(MORTISE_CUDA STREQUAL "ON")
    message(FATAL_ERROR "MORTISE_CUDA=ON, but nvcc was not found")
  endif()
  message(STATUS "CUDA module: not built (no nvcc)")
  return()
endif()
set(CMAKE_CUDA_COMPILER ${MORTISE_NVCC})
if(MORTISE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES ${MORTISE_CUDA_ARCHITECTURES})
else()
  set(CMAKE_CUDA_ARCHITECTURES 75-real 80-real 86-real 89-real 90-real 100-real 120)  # the last with PTX, for GPUs to come
endif()
enable_language(CUDA)
# CMake 3.25 does not know the C++20 flag of nvcc.
if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)
  set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
  set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
endif()
set(CMAKE_CUDA_STANDARD 20)
set(CMAKE_CUDA_STANDARD_REQUIRED ON)
set(MORTISE_HAS_CUDA TRUE)

# How everything that holds kernels is compiled. An Eigen decomposition in device code is only a warning to nvcc, and leaves an
# empty kernel: make it an error, except in tests, which decompose on the host (HOST_EIGEN). --fmad=false keeps the arithmetic
# that of the CPU build (-ffp-contract=off).
function(mortise_cuda_target target)
  cmake_parse_arguments(A HOST_EIGEN "" "" ${ARGN})
  set(eigen -Werror=cross-execution-space-call)
  if(A_HOST_EIGEN)
    set(eigen -diag-suppress=20011,20013,20014,20015)
  endif()
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr --extended-lambda
    ${eigen} -diag-suppress=20012,554 --fmad=false -Xfatbin=-compress-all -Xcompiler=-Wall>)
  set_target_properties(${target} PROPERTIES CUDA_RUNTIME_LIBRARY Static CUDA_VISIBILITY_PRESET hidden)
endfunction()
