/* The JSON Schema of scenes in JSON, from the table of functions. */
#ifndef GRAY_SCRIPT_SCHEMA_H
#define GRAY_SCRIPT_SCHEMA_H

struct document;

/* --json-schema */
void script_json_schema(struct document *document);

#endif
