/* The services of the child, answered on the spot by the desk: no channel, no second process. */
#include "app/alone.h"

#include "app/child.h"
#include "app/desk.h"

#include <signal.h>

struct alone {
    struct desk desk;
    int status;
};

static bool alone_begin(void *context, const struct picture_request *request, struct film *film, bool *already,
                        struct error *error) {
    struct alone *alone = context;
    if (!desk_begin(&alone->desk, request, already, error))
        return false;
    *film = alone->desk.current.film;
    return true;
}

static void alone_abandon(void *context) {
    struct alone *alone = context;
    desk_abandon(&alone->desk);
}

static bool alone_done(void *context, const struct picture_report *report, struct error *error) {
    struct alone *alone = context;
    return desk_done(&alone->desk, report, error);
}

static void alone_line(void *context, enum line_kind kind, const char *text) {
    struct alone *alone = context;
    desk_line(&alone->desk, kind, text);
}

static void alone_script_ended(void *context, int index, int status) {
    struct alone *alone = context;
    (void)index;
    if (status > alone->status)
        alone->status = status;
}

static void alone_poll(void *context) {
    struct alone *alone = context;
    desk_show_progress(&alone->desk);
}

int alone_run(const struct options *options) {
    struct alone alone = {0};
    struct control control = {0};
    struct error error;
    struct child_services services = {.context = &alone,
                                      .control = &control,
                                      .begin = alone_begin,
                                      .abandon = alone_abandon,
                                      .done = alone_done,
                                      .line = alone_line,
                                      .script_ended = alone_script_ended,
                                      .poll = alone_poll};
    pool_raise_stack();
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    desk_init(&alone.desk, options, &control);
    desk_tell_trust(&alone.desk);
    child_run(options, &services, 0);
    if (!desk_finish(&alone.desk, alone.status == 0, &error)) {
        desk_line(&alone.desk, LINE_ERROR, error.text);
        alone_script_ended(&alone, 0, (int)error.kind);
    }
    return alone.status;
}
