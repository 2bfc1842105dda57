/* Writes WebP animations by libwebp: lossless, with every level of every pixel kept. The library keeps the whole file
 * in memory. Times are whole milliseconds; each is rounded separately, so the sum does not drift. */
#include "image/animation.h"

#ifndef HAVE_WEBP

bool webp_write(const struct file_target *target, const struct animation_source *source, struct error *error) {
    (void)source;
    return error_set(error, ERROR_SCENE, WEBP_MISSING, target->path);
}

const char *webp_library(void) {
    return "none";
}

bool webp_can_write(void) {
    return false;
}

#else

#include "base/mem.h"

#include <math.h>
#include <webp/encode.h>
#include <webp/mux.h>

/* With larger values libwebp searches longer; the maxima are 6 and 100. */
enum { METHOD = 2, EFFORT = 40 };

const char *webp_library(void) {
    return "libwebp";
}

bool webp_can_write(void) {
    return true;
}

struct webp {
    const struct animation_source *source;
    const char *path;
    WebPAnimEncoder *encoder;
    WebPConfig config;
    WebPPicture picture;
    uint8_t *rgb;
};

static bool failed(const struct webp *webp, struct error *error) {
    const char *why = webp->encoder ? WebPAnimEncoderGetError(webp->encoder) : "";
    return error_set(error, ERROR_MACHINE, "%.600s: libwebp could not write the animation%s%.200s", webp->path,
                     why[0] ? ": " : "", why);
}

static int milliseconds(const struct animation_source *source, uint32_t index) {
    return (int)floor(1000 * (index / source->rate) + 0.5);
}

static bool begin(struct webp *webp) {
    const struct animation_source *source = webp->source;
    WebPAnimEncoderOptions options;
    if (!WebPAnimEncoderOptionsInit(&options) || !WebPConfigInit(&webp->config) || !WebPPictureInit(&webp->picture))
        return false;
    options.anim_params.loop_count = source->loops ? 0 : 1;
    webp->config.lossless = 1;
    webp->config.exact = 1;
    webp->config.method = METHOD;
    webp->config.quality = EFFORT;
    webp->picture.use_argb = 1;
    webp->picture.width = (int)source->width;
    webp->picture.height = (int)source->height;
    webp->rgb = mem_alloc((size_t)3 * source->width * source->height);
    webp->encoder = WebPAnimEncoderNew(webp->picture.width, webp->picture.height, &options);
    return webp->rgb && webp->encoder && WebPValidateConfig(&webp->config);
}

static bool add_frame(struct webp *webp, uint32_t index, struct error *error) {
    const struct animation_source *source = webp->source;
    if (!source->frame(source->context, index, webp->rgb, error))
        return false;
    return (WebPPictureImportRGB(&webp->picture, webp->rgb, 3 * webp->picture.width) &&
            WebPAnimEncoderAdd(webp->encoder, &webp->picture, milliseconds(source, index), &webp->config)) ||
           failed(webp, error);
}

static bool write_all(struct webp *webp, struct file_output *output, struct error *error) {
    const struct animation_source *source = webp->source;
    WebPData data;
    WebPDataInit(&data);
    bool ok = (WebPAnimEncoderAdd(webp->encoder, NULL, milliseconds(source, source->count), NULL) &&
               WebPAnimEncoderAssemble(webp->encoder, &data)) ||
              failed(webp, error);
    ok = ok && file_output_write(output, data.bytes, data.size, error);
    WebPDataClear(&data);
    return ok;
}

bool webp_write(const struct file_target *target, const struct animation_source *source, struct error *error) {
    struct webp webp = {.source = source, .path = target->path};
    struct file_output output;
    if (source->width > WEBP_MAX_DIMENSION || source->height > WEBP_MAX_DIMENSION)
        return error_set(error, ERROR_SCENE, "%.600s: a WebP file has sides up to %d pixels, not %u x %u", target->path,
                         WEBP_MAX_DIMENSION, source->width, source->height);
    if (1000 * (source->count / source->rate) >= 0x7fffffff)
        return error_set(error, ERROR_SCENE, "%.600s: a WebP file ends before 24 days", target->path);
    if (!file_output_open(&output, target, error))
        return false;
    bool ok = begin(&webp) || error_no_memory(error, target->path);
    for (uint32_t index = 0; ok && index < source->count; index++)
        ok = add_frame(&webp, index, error);
    ok = ok && write_all(&webp, &output, error);
    WebPPictureFree(&webp.picture);
    WebPAnimEncoderDelete(webp.encoder);
    mem_free(webp.rgb);
    if (ok)
        return file_output_commit(&output, error);
    file_output_abandon(&output);
    return false;
}

#endif
