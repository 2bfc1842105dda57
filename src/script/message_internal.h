/* The kinds of messages about a scene that do not stop it. */
#ifndef GRAY_SCRIPT_MESSAGE_INTERNAL_H
#define GRAY_SCRIPT_MESSAGE_INTERNAL_H

enum script_message { SCRIPT_NOTICE, SCRIPT_WARNING };

#endif
