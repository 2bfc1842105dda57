/* The loops of the denoiser for processors with AVX2. Nothing here runs before isa.c has asked the processor;
 * where the compiler knows no AVX2 these are the functions of the base. */
#define KERNELS denoise_kernels_avx2
#include "denoise/denoise_kernel_internal.h"
