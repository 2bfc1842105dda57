/* The text up to a zero byte is the JSON, the rest the binary chunk of a GLB; bytes that begin as a GLB are taken as
 * they are. */
#include "fuzz_model.h"

static void number(uint8_t *out, size_t value) {
    for (int i = 0; i < 4; i++)
        out[i] = (uint8_t)(value >> 8 * i);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const uint8_t *zero = size ? memchr(data, 0, size) : NULL;
    if (!zero || (size >= 4 && memcmp(data, "glTF", 4) == 0)) {
        fuzz_model("fuzz.gltf", data, size);
        return 0;
    }
    size_t text = (size_t)(zero - data), binary = size - text - 1;
    uint8_t *glb = malloc(size + 64);
    if (!glb)
        return 0;
    memcpy(glb, "glTF\2\0\0\0", 8);
    number(glb + 8, 28 + text + binary);
    number(glb + 12, text);
    memcpy(glb + 16, "JSON", 4);
    memcpy(glb + 20, data, text);
    number(glb + 20 + text, binary);
    memcpy(glb + 24 + text, "BIN", 4);
    memcpy(glb + 28 + text, zero + 1, binary);
    fuzz_model("fuzz.glb", glb, 28 + text + binary);
    free(glb);
    return 0;
}
