/* The loops of the denoiser for every processor. */
#define KERNELS denoise_kernels_base
#include "denoise/denoise_kernel_internal.h"
