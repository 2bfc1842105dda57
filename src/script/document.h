/* The table of functions as documents; the text is allocated in the arena. */
#ifndef GRAY_SCRIPT_DOCUMENT_H
#define GRAY_SCRIPT_DOCUMENT_H

struct arena;

const char *script_manual(struct arena *arena);      /* for --man: plain text, 100 columns */
const char *script_annotations(struct arena *arena); /* lua/gr.lua, LuaLS ---@meta */

#endif
