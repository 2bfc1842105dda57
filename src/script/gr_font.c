/* gr.glyphs: a font file is mapped for the time of one call. */
#include "script/bindings_internal.h"
#include "script/context.h"

#include "base/file.h"
#include "formats/font.h"

bool gr_glyphs(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
    char path[PATH_SIZE];
    struct file_bytes bytes;
    struct font_text *text = arena_alloc(&context->call, sizeof *text);
    if (!text)
        return error_no_memory(error, "letters");
    /* Errors that do not depend on files are reported before files are searched. */
    if (!FONTS_READABLE)
        return font_layout(args[GLYPHS_FONT].text, NULL, 0, "", &context->call, text, error);
    if (!files_require(context, args[GLYPHS_FONT].text, path, error) ||
        !path_policy_map(context->path_policy, path, FILE_LIMIT, &bytes, error))
        return false;
    uint64_t refusals = mem_refusals();
    bool done = font_layout(path, bytes.data, bytes.size, args[GLYPHS_TEXT].text, &context->call, text, error);
    file_unmap(&bytes);
    if (!done)
        (void)error_of_file(error, path, refusals);
    for (uint32_t k = 0; done && k < text->count; k++)
        if (text->glyphs[k].missing)
            context_warn_once(context, WARNED_OTHER, "%s has no letter U+%04X, and maybe others", path,
                              text->glyphs[k].code);
    result->pointer = text;
    return done;
}
