/* The channel between supervisor and child: messages arrive complete, and invalid ones are refused. */
#include "base/share.h"
#include "preview/preview_messages.h"
#include "session/messages.h"
#include "tests/harness.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static struct channel ends[2];

static void open_channel(void) {
    struct error error;
    CHECK(channel_pair(ends, &error));
}

static enum channel_result receive(struct message *message) {
    return channel_receive(&ends[0], message);
}

static struct picture_request sound_request(void) {
    struct picture_request request = {.full_width = 100,
                                      .full_height = 80,
                                      .width = 100,
                                      .height = 80,
                                      .shown = {0, 0, 100, 80},
                                      .settings = settings_default()};
    memcpy(request.file, "a.png", 6);
    return request;
}

TEST(frames_keep_their_borders_and_their_order) {
    static struct message message;
    open_channel();
    struct picture_request request = sound_request();
    CHECK(channel_send_line(&ends[1], LINE_WARNING, "one"));
    CHECK(channel_send(&ends[1], MESSAGE_BEGIN, &request, sizeof request, -1));
    CHECK(channel_send_line(&ends[1], LINE_ERROR, ""));
    CHECK_EQ_INT(receive(&message), CHANNEL_MESSAGE);
    CHECK_EQ_INT(message.kind, MESSAGE_LINE);
    CHECK_EQ_INT(message.body.line.kind, LINE_WARNING);
    CHECK_TEXT(message.body.line.text, "one");
    CHECK_EQ_INT(receive(&message), CHANNEL_MESSAGE);
    CHECK_EQ_INT(message.kind, MESSAGE_BEGIN);
    CHECK_TEXT(message.body.request.file, "a.png");
    CHECK_EQ_INT(receive(&message), CHANNEL_MESSAGE);
    CHECK_TEXT(message.body.line.text, "");
    channel_close(&ends[1]);
    CHECK_EQ_INT(receive(&message), CHANNEL_END);
    CHECK(!channel_send_line(&ends[0], LINE_ERROR, "nobody there"));
    channel_close(&ends[0]);
}

TEST(a_line_that_is_too_long_is_cut_with_dots) {
    static struct message message;
    open_channel();
    char *text = malloc(3 * MESSAGE_TEXT_LIMIT);
    memset(text, 'x', 3 * MESSAGE_TEXT_LIMIT);
    text[3 * MESSAGE_TEXT_LIMIT - 1] = '\0';
    CHECK(channel_send_line(&ends[1], LINE_NOTICE, text));
    CHECK_EQ_INT(receive(&message), CHANNEL_MESSAGE);
    CHECK_EQ_INT(strlen(message.body.line.text), MESSAGE_TEXT_LIMIT - 1);
    CHECK_TEXT(message.body.line.text + MESSAGE_TEXT_LIMIT - 4, "...");
    free(text);
}

static void broken(enum message_kind kind, const void *body, size_t size) {
    static struct message message;
    CHECK(channel_send(&ends[1], kind, body, size, -1));
    if (receive(&message) != CHANNEL_BROKEN)
        test_fail(__FILE__, __LINE__, "a frame of kind %d and %zu bytes is taken", (int)kind, size);
}

TEST(frames_of_wrong_kind_size_or_content_are_refused) {
    open_channel();
    char bytes[sizeof(struct picture_request) + 1] = {0};
    broken(0, bytes, 4);
    broken(99, bytes, 4);
    broken(MESSAGE_BEGIN, bytes, 10);
    broken(MESSAGE_BEGIN, bytes, sizeof bytes);
    broken(MESSAGE_DONE, bytes, 1);
    broken(MESSAGE_ABANDON, bytes, 1);
    broken(MESSAGE_SCRIPT, bytes, 3);
    broken(MESSAGE_LINE, bytes, 2);
    struct message_line line = {.kind = (enum line_kind)77, .text = "x"};
    broken(MESSAGE_LINE, &line, offsetof(struct message_line, text) + 2);
    line.kind = LINE_ERROR;
    broken(MESSAGE_LINE, &line, offsetof(struct message_line, text) + 1); /* its text has no terminator */
    CHECK(send(ends[1].descriptor, "ab", 2, 0) == 2);
    static struct message message;
    CHECK_EQ_INT(receive(&message), CHANNEL_BROKEN);
}

static void broken_request(struct picture_request request) {
    broken(MESSAGE_BEGIN, &request, sizeof request);
}

TEST(requests_for_impossible_pictures_are_refused) {
    open_channel();
    struct picture_request request = sound_request();
    request.width = 0;
    broken_request(request);
    request = sound_request();
    request.width = 101;
    broken_request(request);
    request = sound_request();
    request.x0 = 1;
    broken_request(request);
    request = sound_request();
    request.height = 40;
    request.y0 = UINT32_MAX - 10;
    broken_request(request);
    request = sound_request();
    request.full_width = request.width = UINT32_MAX;
    broken_request(request);
    request = sound_request();
    memset(request.file, 'x', sizeof request.file);
    broken_request(request);
    request = sound_request();
    request.height = 0;
    broken_request(request);
    request = sound_request();
    request.height = 81;
    broken_request(request);
    request = sound_request();
    request.full_height = UINT32_MAX;
    broken_request(request);
    static const struct film_rectangle not_in_it[] = {{0, 0, 101, 80},  {0, 0, 100, 81}, {100, 0, 100, 80},
                                                      {0, 80, 100, 80}, {0, 0, 0, 0},    {UINT32_MAX, 0, 5, 5}};
    for (size_t i = 0; i < sizeof not_in_it / sizeof *not_in_it; i++) {
        request = sound_request();
        request.shown = not_in_it[i];
        broken_request(request);
    }
    for (int side = -1; side <= 1; side += 2) {
        request = sound_request();
        request.settings.tone.exposure = (EXPOSURE_AUTO + 1) * side;
        broken_request(request);
    }
    request = sound_request();
    request.settings.tone.curve = (enum tone_curve)1000;
    broken_request(request);
    for (int i = 0; i < 3; i++) {
        request = sound_request();
        request.settings.tone.curve = TONE_FUNCTION;
        request.tone_table.values[i == 0 ? 0 : i == 1 ? 77 : TONE_ENTRIES - 1] = i == 1 ? (float)NAN : (float)INFINITY;
        broken_request(request);
    }
    request = sound_request();
    request.settings.lens.projection = (enum projection)1000;
    broken_request(request);
    request = sound_request();
    request.settings.lens.stereo = (enum stereo)1000;
    broken_request(request);
    request = sound_request();
    static struct message message;
    CHECK(channel_send(&ends[1], MESSAGE_BEGIN, &request, sizeof request, -1));
    CHECK_EQ_INT(receive(&message), CHANNEL_MESSAGE);
}

/* Messages that a child under a scene's control might send: texts without terminator, unknown kinds. */
TEST(answers_and_names_without_an_end_are_refused) {
    open_channel();
    struct message_answer answer;
    memset(&answer, 'x', sizeof answer);
    broken(MESSAGE_ANSWER, &answer, sizeof answer);
    broken(MESSAGE_ANSWER, &answer, 3);
    struct message_read read;
    memset(&read, 'x', sizeof read);
    broken(MESSAGE_READ, &read, sizeof read);
    static const char bytes[MESSAGE_SIZE_LIMIT];
    broken(MESSAGE_READ, bytes, 5);
    broken(MESSAGE_AGAIN, bytes, 1);
    broken(MESSAGE_LINE, bytes, sizeof(struct message_line) + 1);
}

/* A reply that cannot be read is one that the supervisor does not use. */
static void unread(const struct preview_reply *reply, size_t size) {
    static struct message message;
    struct preview_reply out;
    message.kind = MESSAGE_PREVIEW_REPLY;
    message.size = size;
    memcpy(message.body.bytes, reply, sizeof *reply);
    CHECK(!preview_reply_read(&message, &out));
}

TEST(replies_of_a_window_without_an_end_are_refused) {
    static const struct preview_reply sound;
    static struct message message;
    struct preview_reply reply = sound;
    char *const words[] = {reply.picked.name, reply.picked.shape, reply.picked.material, reply.picked.parent_name,
                           reply.root_name};
    message = (struct message){.kind = MESSAGE_PREVIEW_REPLY, .size = sizeof sound};
    CHECK(preview_reply_read(&message, &reply));
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        reply = sound;
        memset(words[i], 'x', PICK_NAME);
        unread(&reply, sizeof reply);
    }
    reply = sound;
    memset(reply.text, 'x', sizeof reply.text);
    unread(&reply, sizeof reply);
    reply = sound;
    memset(reply.picked.node_path, 'x', sizeof reply.picked.node_path);
    unread(&reply, sizeof reply);
    reply = sound;
    reply.kind = (enum preview_reply_kind)1000;
    unread(&reply, sizeof reply);
    unread(&sound, sizeof sound - 1);
    struct preview_command command;
    CHECK(!preview_command_read(&message, &command)); /* of another kind */
}

TEST(a_channel_that_is_closed_twice_is_closed_once) {
    static struct message message;
    open_channel();
    channel_close(&ends[1]);
    channel_close(&ends[1]);
    CHECK_EQ_INT(receive(&message), CHANNEL_END);
}

TEST(shared_memory_passes_through_the_channel) {
    static struct message message;
    open_channel();
    struct share mine, theirs;
    struct error error;
    struct message_answer answer = {.ok = true};
    CHECK(share_create(&mine, 100000, &error));
    CHECK(channel_send(&ends[1], MESSAGE_FILM, &answer, sizeof answer, mine.descriptor));
    CHECK_EQ_INT(receive(&message), CHANNEL_MESSAGE);
    CHECK(message.descriptor >= 0);
    CHECK(share_attach(&theirs, message.descriptor, 100000, &error));
    CHECK_EQ_INT(((char *)theirs.block)[99999], 0);
    ((char *)theirs.block)[99999] = 42;
    CHECK_EQ_INT(((char *)mine.block)[99999], 42);
    CHECK(ftruncate(theirs.descriptor, 10) != 0);
    share_destroy(&theirs);
    /* A descriptor in a message that has none, and memory that is too small. */
    CHECK(channel_send(&ends[1], MESSAGE_ABANDON, NULL, 0, mine.descriptor));
    CHECK_EQ_INT(receive(&message), CHANNEL_BROKEN);
    CHECK(!share_attach(&theirs, dup(mine.descriptor), 200000, &error));
    CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    share_destroy(&mine);
}

TEST(shared_memory_larger_than_the_machine_is_refused) {
    struct share share;
    struct error error;
    CHECK(!share_create(&share, (size_t)1 << 50, &error));
    CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    CHECK(strstr(error.text, "out of memory"));
}
