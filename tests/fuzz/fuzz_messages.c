/* Any bytes as messages from a render process under a scene's control to its supervisor: invalid messages are refused;
 * valid ones begin, finish and abandon pictures in a private folder and change nothing outside it. In the input each
 * message is a length of two bytes, little-endian, and that many bytes; the rest is zero if the kind has a fixed size.
 */
#include "output/output_session.h"
#include "session/messages.h"
#include "tests/fuzz/folder.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The sizes of the kinds that this target tests; others are sent with the length in the input. */
static size_t whole_size(uint32_t kind, size_t size) {
    if (kind == MESSAGE_BEGIN)
        return sizeof(struct picture_request);
    if (kind == MESSAGE_DONE)
        return sizeof(struct picture_report);
    if (kind == MESSAGE_SCRIPT)
        return sizeof(struct message_script);
    return kind == MESSAGE_FILM || kind == MESSAGE_ANSWER ? sizeof(struct message_answer) : size;
}

/* As in the supervisor. */
static bool take(struct output_session *output, const struct message *message) {
    const struct picture_request *request = &message->body.request;
    struct error error = {0};
    bool already = false, ok = true, fits = true;
    if (message->kind == MESSAGE_LINE) {
        output_report(output, message->body.line.kind, message->body.line.text);
    } else if (message->kind == MESSAGE_BEGIN) {
        fits = !output->current.open && (uint64_t)request->width * request->height <= 1 << 14;
        ok = !fits || output_begin(output, request, &already, &error);
    } else if (message->kind == MESSAGE_DONE) {
        fits = output->current.open && !output->current.request.check;
        ok = !fits || output_done(output, &message->body.report, &error);
    } else if (message->kind == MESSAGE_ABANDON) {
        output_abandon(output);
    } else {
        fits = false;
    }
    if (!ok && error.kind == ERROR_NONE)
        abort();
    return fits;
}

static void talk(struct output_session *output, struct channel ends[2], const uint8_t *data, size_t size) {
    static struct message message;
    static uint8_t body[sizeof message.body]; /* the largest body of any kind */
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
        if (!channel_send(&ends[1], (enum message_kind)(kind & 127), body, whole, -1) ||
            channel_receive(&ends[0], &message) != CHANNEL_MESSAGE || !take(output, &message))
            return;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct options options = {.statistics = size % 2 ? STATISTICS_TEXT : STATISTICS_JSON, .progress = PROGRESS_NONE};
    struct control control = {0};
    struct channel ends[2];
    struct error error = {0};
    static struct output_session output;
    (void)fuzz_folder();
    if (!channel_pair(ends, &error))
        return 0;
    fuzz_hush(true);
    output_init(&output, &options, &control);
    talk(&output, ends, data, size);
    output_abandon(&output);
    (void)output_finish(&output, false, &error);
    fuzz_hush(false);
    channel_close(&ends[0]);
    channel_close(&ends[1]);
    fuzz_empty_folder();
    return 0;
}
