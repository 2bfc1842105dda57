/* gray-gui: the same program with a window, by SDL 2. `gray -gui` becomes it. The picture is a texture that is scaled
 * to the window with its shape kept; everything that people do is told in shares of the picture. */
#define _GNU_SOURCE
#include "app/program.h"

#include <SDL.h>

struct sdl {
    SDL_Window *window;
    SDL_Renderer *renderer;
    SDL_Texture *texture;
    uint32_t width, height; /* of the picture */
    bool full;
};

static void close_window(void *context) {
    struct sdl *sdl = context;
    if (sdl->texture)
        SDL_DestroyTexture(sdl->texture);
    if (sdl->renderer)
        SDL_DestroyRenderer(sdl->renderer);
    if (sdl->window)
        SDL_DestroyWindow(sdl->window);
    SDL_Quit();
    *sdl = (struct sdl){0};
}

static bool open_window(void *context, uint32_t width, uint32_t height, const char *title, struct error *error) {
    struct sdl *sdl = context;
    SDL_DisplayMode screen;
    int w = (int)width, h = (int)height;
    *sdl = (struct sdl){.width = width, .height = height};
    (void)SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    (void)SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
    if (SDL_Init(SDL_INIT_VIDEO) == 0) {
        /* No larger than nine tenths of the screen, and no smaller than people can click into. */
        if (SDL_GetDesktopDisplayMode(0, &screen) == 0) {
            double fit = SDL_min(0.9 * screen.w / w, 0.9 * screen.h / h);
            if (fit < 1) {
                w = (int)SDL_max(1, w * fit);
                h = (int)SDL_max(1, h * fit);
            }
        }
        sdl->window = SDL_CreateWindow(title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, SDL_max(w, 160),
                                       SDL_max(h, 120), SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
    }
    if (sdl->window)
        sdl->renderer = SDL_CreateRenderer(sdl->window, -1, 0);
    if (sdl->renderer) {
        (void)SDL_RenderSetLogicalSize(sdl->renderer, (int)width, (int)height);
        sdl->texture = SDL_CreateTexture(sdl->renderer, SDL_PIXELFORMAT_RGB24, SDL_TEXTUREACCESS_STREAMING, (int)width,
                                         (int)height);
    }
    if (sdl->texture)
        return true;
    error_set(error, ERROR_MACHINE, "-gui: no window can be opened: %s", SDL_GetError());
    close_window(sdl);
    return false;
}

static void present(struct sdl *sdl) {
    (void)SDL_RenderClear(sdl->renderer);
    (void)SDL_RenderCopy(sdl->renderer, sdl->texture, NULL, NULL);
    SDL_RenderPresent(sdl->renderer);
}

static void show_picture(void *context, const uint8_t *rgb, uint32_t width, uint32_t height) {
    struct sdl *sdl = context;
    (void)height;
    (void)SDL_UpdateTexture(sdl->texture, NULL, rgb, 3 * (int)width);
    present(sdl);
}

static void set_title(void *context, const char *text) {
    struct sdl *sdl = context;
    SDL_SetWindowTitle(sdl->window, text);
}

static void set_grab(void *context, bool on) {
    (void)context;
    (void)SDL_SetRelativeMouseMode(on ? SDL_TRUE : SDL_FALSE);
}

static void turn_full_screen(void *context) {
    struct sdl *sdl = context;
    sdl->full = !sdl->full;
    (void)SDL_SetWindowFullscreen(sdl->window, sdl->full ? SDL_WINDOW_FULLSCREEN_DESKTOP : 0);
}

static int key_of(SDL_Keycode code) {
    switch (code) {
    case SDLK_ESCAPE:
        return WINDOW_ESCAPE;
    case SDLK_SPACE:
        return WINDOW_SPACE;
    case SDLK_LSHIFT:
    case SDLK_RSHIFT:
        return WINDOW_SHIFT;
    case SDLK_LCTRL:
    case SDLK_RCTRL:
        return WINDOW_CONTROL;
    case SDLK_UP:
        return WINDOW_ARROW_UP;
    case SDLK_DOWN:
        return WINDOW_ARROW_DOWN;
    case SDLK_LEFT:
        return WINDOW_ARROW_LEFT;
    case SDLK_RIGHT:
        return WINDOW_ARROW_RIGHT;
    case SDLK_HOME:
        return WINDOW_HOME;
    case SDLK_F11:
        return 'f';
    default:
        return code > 0 && code < 128 ? (int)code : 0;
    }
}

static int button_of(int button) {
    return button == SDL_BUTTON_LEFT ? WINDOW_LEFT : button == SDL_BUTTON_RIGHT ? WINDOW_RIGHT : WINDOW_MIDDLE;
}

/* True: it is one that the program knows. */
static bool translate(struct sdl *sdl, const SDL_Event *in, struct window_event *out) {
    *out = (struct window_event){0};
    switch (in->type) {
    case SDL_QUIT:
        out->kind = WINDOW_CLOSE;
        return true;
    case SDL_KEYDOWN:
    case SDL_KEYUP:
        out->kind = WINDOW_KEY;
        out->key = key_of(in->key.keysym.sym);
        out->down = in->type == SDL_KEYDOWN;
        out->control = (in->key.keysym.mod & KMOD_CTRL) != 0;
        return out->key != 0 && in->key.repeat == 0;
    case SDL_MOUSEMOTION:
        out->kind = WINDOW_MOVE;
        out->x = (double)in->motion.xrel / sdl->height;
        out->y = (double)in->motion.yrel / sdl->height;
        return true;
    case SDL_MOUSEWHEEL:
        out->kind = WINDOW_WHEEL;
        out->y = in->wheel.y;
        return true;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        out->kind = in->type == SDL_MOUSEBUTTONDOWN ? WINDOW_PRESS : WINDOW_RELEASE;
        out->button = button_of(in->button.button);
        out->x = (double)in->button.x / sdl->width;
        out->y = (double)in->button.y / sdl->height;
        return true;
    case SDL_WINDOWEVENT:
        if (in->window.event == SDL_WINDOWEVENT_EXPOSED || in->window.event == SDL_WINDOWEVENT_SIZE_CHANGED)
            present(sdl);
        out->kind = WINDOW_LEAVE;
        return in->window.event == SDL_WINDOWEVENT_FOCUS_LOST;
    default:
        return false;
    }
}

static bool poll_event(void *context, struct window_event *event) {
    struct sdl *sdl = context;
    SDL_Event in;
    while (SDL_PollEvent(&in)) {
        if (translate(sdl, &in, event))
            return true;
    }
    return false;
}

int main(int argc, char **argv) {
    struct sdl sdl = {0};
    const struct window_driver driver = {.context = &sdl,
                                         .open = open_window,
                                         .show = show_picture,
                                         .poll = poll_event,
                                         .title = set_title,
                                         .grab = set_grab,
                                         .full_screen = turn_full_screen,
                                         .close = close_window};
    return program_run(argc, argv, &(struct program_parts){.window = &driver});
}
