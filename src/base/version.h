/* The version number. */
#ifndef GRAY_BASE_VERSION_H
#define GRAY_BASE_VERSION_H

#define GRAY_VERSION "0.1.0"

#endif
