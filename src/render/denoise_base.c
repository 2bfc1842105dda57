/* The loops of the denoiser for every processor. */
#define KERNELS denoise_kernels_base
#include "render/denoise_kernel_internal.h"
