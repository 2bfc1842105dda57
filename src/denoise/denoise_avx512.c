/* The loops of the denoiser for processors with AVX-512. Nothing here runs before isa.c has asked the processor;
 * where the compiler knows no AVX-512 these are the functions of the base. */
#define KERNELS denoise_kernels_avx512
#include "denoise/denoise_kernel_internal.h"
