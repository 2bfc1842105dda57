/* The kinds of messages about a scene that do not stop it. */
#ifndef GRAY_SANDBOX_MESSAGE_H
#define GRAY_SANDBOX_MESSAGE_H

enum script_message { SCRIPT_NOTICE, SCRIPT_WARNING };

#endif
