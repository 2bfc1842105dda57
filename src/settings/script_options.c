/* Which options of settings were given, and the limits of scripts that no option sets: without the sandbox none. */
#include "settings/script_options.h"

#include "base/error.h"
#include "settings/setting.h"

static const double usual_time = 60;
static const uint64_t usual_memory = 4 * GIBIBYTE, usual_output = 64 * MEBIBYTE;

bool script_option_given(const struct script_options *options, int setting) {
    return options->given && options->given[setting];
}

bool script_option_chosen(const struct script_options *options, int setting) {
    return script_option_given(options, setting) ||
           (setting < setting_field_count && (options->defaults >> setting & 1));
}

double script_time_limit(const struct script_options *options) {
    return options->time_limit > 0 || options->no_sandbox ? options->time_limit : usual_time;
}

static uint64_t limit_of(uint64_t given, uint64_t usual, const struct script_options *options) {
    return given > 0 ? given : options->no_sandbox ? 0 : usual;
}

uint64_t script_memory_limit(const struct script_options *options) {
    return limit_of(options->memory_limit, usual_memory, options);
}

uint64_t script_output_limit(const struct script_options *options) {
    return limit_of(options->output_limit, usual_output, options);
}

uint64_t script_picture_memory(const struct script_options *options) {
    uint64_t limit = script_memory_limit(options);
    return limit > 0 ? limit + limit / 4 * 3 : UINT64_MAX;
}
