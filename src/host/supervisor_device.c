#define _GNU_SOURCE
#include "host/supervisor_device.h"

#include "base/fault.h"
#include "base/file.h"
#include "base/mem.h"
#include "device/cuda.h"
#include "device/device_link.h"
#include "device/kernels_file.h"
#include "host/confine.h"
#include "host/supervisor_child.h"
#include "host/supervisor_messages.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Driver and kernels need files and memory that is executed, so they are loaded before the rights go. */
static struct cuda *open_card(struct cuda_calls *calls, bool measures, struct error *error) {
    char name[4096 + sizeof "gray-kernels"] = "";
    char *slash = file_canonical("/proc/self/exe", name, 4096) ? strrchr(name, '/') : NULL;
    (void)strcpy(slash ? slash + 1 : name, "gray-kernels");
    struct file_bytes kernels;
    if (!cuda_calls_load(calls, error) || !kernels_file_open(name, &kernels, error))
        return NULL;
    struct cuda *cuda = cuda_create(calls, &kernels, measures, error);
    file_unmap(&kernels);
    return cuda;
}

/* After the fork. The process needs two pieces of memory and its threads, or the files of a driver that are open:
 * everything else is taken away before it looks at the scene, which a render process has written. */
static _Noreturn void run_as_device(struct supervisor *supervisor, pid_t parent, struct device_slots slots) {
    const bool is_card = supervisor->options->device != DEVICE_EMULATE;
    struct cuda_calls calls;
    struct cuda *cuda = NULL;
    struct share link = {0};
    struct error error;
    char report[4096];
    size_t size = 0;
    const bool is_confined = !supervisor->options->script.no_sandbox;
    int orders = supervisor->device.link.descriptor, scene = supervisor->device.scene;
    supervisor_begin_child(supervisor, parent);
    (void)file_null_input();
    void *bytes = share_map_copy(scene, &size, &error);
    bool ok = bytes && share_attach(&link, orders, device_link_size(slots), &error);
    if (is_confined)
        confine_descriptors(STDERR_FILENO);
    ok = ok && (!is_card || (cuda = open_card(&calls, supervisor->options->device == DEVICE_AUTO, &error)) != NULL) &&
         (!is_confined || confine_device(is_card, report, sizeof report, &error)) &&
         device_link_serve(link.block, cuda, bytes, size, slots, &error);
    if (!ok && link.block)
        device_link_refuse(link.block, error.text);
    _exit(ok ? 0 : (int)error.kind);
}

static bool start(struct supervisor *supervisor, struct device_slots slots, struct error *error) {
    struct device_process *device = &supervisor->device;
    if (!share_freeze(device->scene))
        return error_set(error, ERROR_MACHINE, "the memory of a scene cannot be sealed: %s", strerror(errno));
    if (!share_create(&device->link, device_link_size(slots), error))
        return false;
    (void)fflush(NULL);
    pid_t parent = getpid();
    device->process = MAY_FAIL(fork());
    if (device->process == 0)
        run_as_device(supervisor, parent, slots);
    int why = errno;
    (void)close(device->scene);
    device->asked = false;
    if (device->process > 0)
        return true;
    device->process = 0;
    share_destroy(&device->link);
    return error_set(error, ERROR_MACHINE, "the device process cannot be started: %s", strerror(why));
}

void supervisor_answer_device(struct supervisor *supervisor, const struct device_request *request) {
    struct device_process *device = &supervisor->device;
    struct error error = {0};
    bool ok;
    int descriptor;
    if (request->size > 0) {
        supervisor_end_device(supervisor);
        descriptor = device->scene = share_create_open((size_t)request->size, &error);
        ok = device->asked = descriptor >= 0;
    } else {
        ok = start(supervisor, (struct device_slots){request->slots, request->room}, &error);
        descriptor = ok ? device->link.descriptor : -1;
    }
    supervisor_send_answer(supervisor, MESSAGE_FILM, ok, false, &error, descriptor);
}

void supervisor_watch_device(struct supervisor *supervisor) {
    struct device_process *device = &supervisor->device;
    char line[DEVICE_REASON + 128], reason[DEVICE_REASON];
    int how;
    if (device->process == 0 || waitpid(device->process, &how, WNOHANG) != device->process)
        return;
    device->process = 0;
    device_link_close(device->link.block);
    if (WIFEXITED(how) && WEXITSTATUS(how) == 0) /* the render process does not want it */
        return;
    device_link_reason(device->link.block, reason);
    if (WIFSIGNALED(how))
        (void)snprintf(line, sizeof line, "gray: warning: the device process was killed (signal %d, %s)", WTERMSIG(how),
                       strsignal(WTERMSIG(how)));
    else if (reason[0])
        (void)snprintf(line, sizeof line, "gray: warning: %s", reason);
    else
        (void)snprintf(line, sizeof line, "gray: warning: the device process ended with status %d", WEXITSTATUS(how));
    (void)strncat(line, "; the processor goes on, and the picture is the same", sizeof line - strlen(line) - 1);
    if (device_link_was_ready(device->link.block) || supervisor->options->device == DEVICE_EMULATE)
        supervisor_report(supervisor, LINE_WARNING, line);
}

struct device_statistics supervisor_device_statistics(const struct supervisor *supervisor) {
    struct device_link *link = supervisor->device.link.block;
    return link ? device_link_statistics(link) : (struct device_statistics){0};
}

void supervisor_end_device(struct supervisor *supervisor) {
    struct device_process *device = &supervisor->device;
    if (device->process > 0) {
        (void)kill(device->process, SIGKILL);
        (void)waitpid(device->process, NULL, 0);
    }
    if (device->asked)
        (void)close(device->scene);
    share_destroy(&device->link);
    device->process = 0;
    device->asked = false;
}
