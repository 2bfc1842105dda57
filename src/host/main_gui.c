/* gray-gui: the same program with a window, by SDL 2. `gray -gui` becomes it. Two textures, the picture and what is
 * drawn over it, are drawn over each other; every frame has the position of the picture. SDL reports the mouse in units
 * of the desktop, which have several pixels on a screen of high density: this file converts everything to pixels. */
#define _GNU_SOURCE
#include "host/program.h"

#include <SDL.h>

struct screen_texture {
    SDL_Texture *pixels; /* or NULL */
    int width, height;
};

struct sdl {
    SDL_Window *window;
    SDL_Renderer *renderer;
    struct screen_texture picture, overlay;
    int width, height; /* of the window in pixels */
    double unit;       /* pixels per unit of the desktop, in which SDL reports the mouse */
    double density;    /* pixels per dot of a letter */
    bool full, size_sent;
    int given_width, given_height; /* of the window in units of the desktop, as this program has set it */
};

static void close_window(void *context) {
    struct sdl *sdl = context;
    if (sdl->overlay.pixels)
        SDL_DestroyTexture(sdl->overlay.pixels);
    if (sdl->picture.pixels)
        SDL_DestroyTexture(sdl->picture.pixels);
    if (sdl->renderer)
        SDL_DestroyRenderer(sdl->renderer);
    if (sdl->window)
        SDL_DestroyWindow(sdl->window);
    SDL_Quit();
    *sdl = (struct sdl){0};
}

/* If the units of the desktop are the pixels of the screen (X11), the scale comes from the environment (GDK_SCALE,
 * which desktops set), or from the dots per inch divided by 96. Values below 1.5 and above 10 are ignored: many screens
 * report wrong numbers. */
static double screen_density(SDL_Window *window) {
    const char *said = SDL_getenv("GDK_SCALE");
    float across = 0, dots = 0;
    int screen = SDL_GetWindowDisplayIndex(window);
    double density = said ? SDL_atof(said) : 0;
    if (!(density > 0) && screen >= 0 && SDL_GetDisplayDPI(screen, NULL, &across, &dots) == 0)
        density = (double)SDL_min(across, dots) / 96;
    return density >= 1.5 && density <= 10 ? SDL_floor(2 * density + 0.5) / 2 : 1;
}

/* True: the size has changed. */
static bool measure(struct sdl *sdl) {
    int width = 0, height = 0, units = 0, ignored = 0;
    if (SDL_GetRendererOutputSize(sdl->renderer, &width, &height) != 0)
        return false;
    SDL_GetWindowSize(sdl->window, &units, &ignored);
    bool other = width != sdl->width || height != sdl->height || !sdl->size_sent;
    sdl->width = width;
    sdl->height = height;
    sdl->unit = units > 0 && width > 0 ? (double)width / units : 1;
    sdl->density = SDL_max(sdl->unit, screen_density(sdl->window));
    return other;
}

/* Makes sure that the texture has this size; *other: it is new and has no contents. False: it cannot be created. */
static bool fit_texture(SDL_Renderer *renderer, struct screen_texture *texture, Uint32 format, uint32_t width,
                        uint32_t height, bool *other) {
    *other = !texture->pixels || texture->width != (int)width || texture->height != (int)height;
    if (!*other)
        return true;
    if (texture->pixels)
        SDL_DestroyTexture(texture->pixels);
    *texture = (struct screen_texture){NULL, (int)width, (int)height};
    texture->pixels = SDL_CreateTexture(renderer, format, SDL_TEXTUREACCESS_STREAMING, texture->width, texture->height);
    return texture->pixels != NULL;
}

/* A size for the window: no larger than nine tenths of the screen, and not too small to use. */
static void choose_size(int *w, int *h) {
    SDL_DisplayMode screen;
    if (SDL_GetDesktopDisplayMode(0, &screen) == 0) {
        double fit = SDL_min(0.9 * screen.w / *w, 0.9 * screen.h / *h);
        if (fit < 1) {
            *w = (int)(*w * fit);
            *h = (int)(*h * fit);
        }
    }
    *w = SDL_max(*w, 160);
    *h = SDL_max(*h, 120);
}

/* Gives the window the size of another picture, if the window still has the size that this program has set. */
static void fit_window(struct sdl *sdl, uint32_t width, uint32_t height) {
    int w = (int)width, h = (int)height, now_width, now_height;
    SDL_GetWindowSize(sdl->window, &now_width, &now_height);
    if (sdl->full || now_width != sdl->given_width || now_height != sdl->given_height)
        return;
    choose_size(&w, &h);
    SDL_SetWindowSize(sdl->window, w, h);
    sdl->given_width = w;
    sdl->given_height = h;
}

static bool open_window(void *context, uint32_t width, uint32_t height, const char *title, struct error *error) {
    struct sdl *sdl = context;
    int w = (int)width, h = (int)height;
    *sdl = (struct sdl){0};
    (void)SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    (void)SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
    if (SDL_Init(SDL_INIT_VIDEO) == 0) {
        choose_size(&w, &h);
        sdl->window = SDL_CreateWindow(title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, w, h,
                                       SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
    }
    sdl->given_width = w;
    sdl->given_height = h;
    if (sdl->window)
        sdl->renderer = SDL_CreateRenderer(sdl->window, -1, 0);
    bool ignored;
    if (sdl->renderer && fit_texture(sdl->renderer, &sdl->picture, SDL_PIXELFORMAT_RGB24, width, height, &ignored) &&
        measure(sdl))
        return true;
    error_set(error, ERROR_MACHINE, "-gui: no window can be opened: %s", SDL_GetError());
    close_window(sdl);
    return false;
}

static void show_frame(void *context, const struct window_content *frame) {
    struct sdl *sdl = context;
    SDL_Rect target = {frame->left, frame->top, frame->shown_width, frame->shown_height};
    bool other;
    if (frame->fit_width > 0)
        fit_window(sdl, frame->fit_width, frame->fit_height);
    bool has_picture =
        fit_texture(sdl->renderer, &sdl->picture, SDL_PIXELFORMAT_RGB24, frame->width, frame->height, &other);
    if (has_picture && (frame->picture_changed || other))
        (void)SDL_UpdateTexture(sdl->picture.pixels, NULL, frame->picture, 3 * (int)frame->width);
    bool over = frame->overlay &&
                fit_texture(sdl->renderer, &sdl->overlay, SDL_PIXELFORMAT_RGBA32, frame->window_width,
                            frame->window_height, &other) &&
                SDL_SetTextureBlendMode(sdl->overlay.pixels, SDL_BLENDMODE_BLEND) == 0;
    if (over && (frame->overlay_changed || other))
        (void)SDL_UpdateTexture(sdl->overlay.pixels, NULL, frame->overlay, 4 * (int)frame->window_width);
    (void)SDL_RenderClear(sdl->renderer);
    if (has_picture)
        (void)SDL_RenderCopy(sdl->renderer, sdl->picture.pixels, NULL, &target);
    if (over)
        (void)SDL_RenderCopy(sdl->renderer, sdl->overlay.pixels, NULL, NULL);
    SDL_RenderPresent(sdl->renderer);
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
    case SDLK_DELETE:
        return WINDOW_DELETE;
    case SDLK_PAGEUP:
        return WINDOW_PAGE_UP;
    case SDLK_PAGEDOWN:
        return WINDOW_PAGE_DOWN;
    case SDLK_TAB:
        return WINDOW_TAB;
    case SDLK_F11:
        return 'f';
    default:
        return code > 0 && code < 128 ? (int)code : 0;
    }
}

static int button_of(int button) {
    return button == SDL_BUTTON_LEFT ? WINDOW_LEFT : button == SDL_BUTTON_RIGHT ? WINDOW_RIGHT : WINDOW_MIDDLE;
}

static void send_size(struct sdl *sdl, struct window_event *out) {
    sdl->size_sent = true;
    *out = (struct window_event){.kind = WINDOW_SIZE, .x = sdl->width, .y = sdl->height, .density = sdl->density};
}

/* True: the program uses this event. */
static bool translate(struct sdl *sdl, const SDL_Event *in, struct window_event *out) {
    double density = sdl->unit;
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
        out->shift = (in->key.keysym.mod & KMOD_SHIFT) != 0;
        return out->key != 0 && in->key.repeat == 0;
    case SDL_MOUSEMOTION:
        *out = (struct window_event){.kind = WINDOW_MOVE,
                                     .x = density * in->motion.x,
                                     .y = density * in->motion.y,
                                     .dx = density * in->motion.xrel,
                                     .dy = density * in->motion.yrel};
        return true;
    case SDL_MOUSEWHEEL:
        out->kind = WINDOW_WHEEL;
        out->y = in->wheel.y;
        return true;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        out->kind = in->type == SDL_MOUSEBUTTONDOWN ? WINDOW_PRESS : WINDOW_RELEASE;
        out->button = button_of(in->button.button);
        out->x = density * in->button.x;
        out->y = density * in->button.y;
        out->control = (SDL_GetModState() & KMOD_CTRL) != 0;
        out->shift = (SDL_GetModState() & KMOD_SHIFT) != 0;
        return true;
    case SDL_WINDOWEVENT:
        /* The receiver of the size draws covered parts again. */
        if (in->window.event == SDL_WINDOWEVENT_EXPOSED || in->window.event == SDL_WINDOWEVENT_SIZE_CHANGED) {
            (void)measure(sdl);
            send_size(sdl, out);
            return true;
        }
        out->kind = WINDOW_LEAVE;
        return in->window.event == SDL_WINDOWEVENT_FOCUS_LOST;
    default:
        return false;
    }
}

static bool poll_event(void *context, struct window_event *event) {
    struct sdl *sdl = context;
    SDL_Event in;
    if (!sdl->size_sent) {
        send_size(sdl, event);
        return true;
    }
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
                                         .show = show_frame,
                                         .poll = poll_event,
                                         .title = set_title,
                                         .grab = set_grab,
                                         .full_screen = turn_full_screen,
                                         .close = close_window};
    return program_run(argc, argv, &(struct program_parts){.window = &driver});
}
