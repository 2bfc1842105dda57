/* Any bytes as the text of a scene whose order of transforms is guessed before it runs: an order and a short reason. */
#include "compat/order.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct order_finding finding;
    char *text = malloc(size + 1); /* of the exact size, so that a sanitizer detects a read past the end */
    if (!text)
        return 0;
    if (size)
        memcpy(text, data, size);
    order_of_text(text, size, &finding);
    if (finding.order != TRANSFORM_ORDER_NEW && finding.order != TRANSFORM_ORDER_OLD &&
        finding.order != TRANSFORM_ORDER_SEPARATE)
        abort();
    if (!memchr(finding.reason, '\0', sizeof finding.reason) || strchr(finding.reason, '\n'))
        abort();
    free(text);
    return 0;
}
