/* gray-gui: the same program with a window by GTK 4. The window is a process of its own, forked before that process has
 * a thread, so this one forks render processes as ever. It stays open from one scene to the next. */
#define _GNU_SOURCE
#include "host/program.h"
#include "window/gtk_window.h"
#include "window/window_channel.h"

#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

struct gtk_process {
    struct window_channel window;
    struct window_driver driver; /* of the channel */
    pid_t process;               /* 0: not started */
};

/* The child keeps the channel and the standard streams. */
static _Noreturn void run_window(struct channel channel) {
    enum { FIRST = 3 };
    if (channel.descriptor != FIRST)
        (void)dup2(channel.descriptor, FIRST);
    (void)close_range(FIRST + 1, ~0u, 0);
    (void)prctl(PR_SET_PDEATHSIG, SIGTERM);
    _exit(gtk_window_run((struct channel){FIRST}));
}

static bool start(struct gtk_process *gtk, struct error *error) {
    struct channel ends[2];
    if (!channel_pair(ends, error))
        return false;
    gtk->process = fork();
    if (gtk->process == 0)
        run_window(ends[1]);
    channel_close(&ends[1]);
    gtk->window.channel = ends[0];
    return true;
}

static bool open_window(void *context, struct error *error) {
    struct gtk_process *gtk = context;
    return (gtk->process > 0 || start(gtk, error)) && window_channel_wait(&gtk->window, error) &&
           gtk->driver.open(&gtk->window, error);
}

int main(int argc, char **argv) {
    static struct gtk_process gtk = {.window.channel.descriptor = -1};
    gtk.driver = window_channel_driver(&gtk.window);
    struct window_driver driver = gtk.driver;
    driver.open = open_window;
    driver.context = &gtk; /* its first member is the window */
    struct program_parts parts = {.window = &driver};
    int status = program_run(argc, argv, &parts);
    /* A run ends because the user has opened another scene, or closed the window, or by a signal. */
    while (gtk.process > 0 && (gtk.window.empty || gtk.window.scene[0] != '\0') &&
           window_channel_next_scene(&gtk.window)) {
        char scene[sizeof gtk.window.scene];
        memcpy(scene, gtk.window.scene, sizeof scene);
        gtk.window.scene[0] = '\0';
        status = program_run(4, (char *[]){argv[0], "-gui", "--", scene, NULL}, &parts);
    }
    window_channel_destroy(&gtk.window);
    if (gtk.process > 0)
        (void)waitpid(gtk.process, NULL, 0);
    return status;
}
