/* Any bytes as what a rendering process that a scene has taken over says to its supervisor: frames that are not sound
 * are refused, sound ones begin, finish and give up pictures in a folder of their own, and nothing outside of it. Each
 * frame is a length of two bytes, little-endian, and so many bytes, the rest being zero where the kind has a fixed
 * size. */
#include "output/output_session.h"
#include "session/channel.h"
#include "tests/fuzz/folder.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Of the kinds that this target is about; others are sent as long as they are. */
static size_t whole_size(uint32_t kind, size_t size) {
    if (kind == FRAME_BEGIN)
        return sizeof(struct picture_request);
    if (kind == FRAME_NEWS)
        return sizeof(struct studio_news);
    if (kind == FRAME_DONE)
        return sizeof(struct picture_report);
    if (kind == FRAME_SCRIPT)
        return sizeof(struct frame_script);
    return kind == FRAME_FILM || kind == FRAME_ANSWER ? sizeof(struct frame_answer) : size;
}

/* As the supervisor does. */
static bool take(struct desk *desk, const struct frame *frame) {
    const struct picture_request *request = &frame->body.request;
    struct error error = {0};
    bool already = false, ok = true, fits = true;
    if (frame->kind == FRAME_LINE) {
        desk_line(desk, frame->body.line.kind, frame->body.line.text);
    } else if (frame->kind == FRAME_BEGIN) {
        fits = !desk->current.open && (uint64_t)request->width * request->height <= 1 << 14;
        ok = !fits || desk_begin(desk, request, &already, &error);
    } else if (frame->kind == FRAME_DONE) {
        fits = desk->current.open && !desk->current.request.check;
        ok = !fits || desk_done(desk, &frame->body.report, &error);
    } else if (frame->kind == FRAME_ABANDON) {
        desk_abandon(desk);
    } else {
        fits = false;
    }
    if (!ok && error.kind == ERROR_NONE)
        abort();
    return fits;
}

static void talk(struct desk *desk, struct channel ends[2], const uint8_t *data, size_t size) {
    static uint8_t body[FRAME_SIZE_LIMIT];
    static struct frame frame;
    for (size_t at = 0; size - at >= 3;) {
        size_t length = data[at] | (size_t)data[at + 1] << 8;
        uint32_t kind = data[at + 2];
        at += 3;
        length = length < size - at ? length : size - at;
        length = length < sizeof body ? length : sizeof body;
        memset(body, 0, sizeof body);
        memcpy(body, data + at, length);
        at += length;
        size_t whole = kind & 128 ? length : whole_size(kind, length);
        if (!channel_send(&ends[1], (enum frame_kind)(kind & 127), body, whole, -1) ||
            channel_receive(&ends[0], &frame) != CHANNEL_FRAME || !take(desk, &frame))
            return;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct options options = {.statistics = size % 2 ? STATISTICS_TEXT : STATISTICS_JSON, .progress = PROGRESS_NONE};
    struct control control = {0};
    struct channel ends[2];
    struct error error = {0};
    static struct desk desk;
    (void)fuzz_folder();
    if (!channel_pair(ends, &error))
        return 0;
    fuzz_hush(true);
    desk_init(&desk, &options, &control);
    talk(&desk, ends, data, size);
    desk_abandon(&desk);
    (void)desk_finish(&desk, false, &error);
    fuzz_hush(false);
    channel_close(&ends[0]);
    channel_close(&ends[1]);
    fuzz_empty_folder();
    return 0;
}
