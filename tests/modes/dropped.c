/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dropped SPEC MODES PREFIX [ header ]: C of what the outputs of a model lose when the MODES that matter most are kept,
 * as a model of its own. */
#include "emit/emit.h"
#include "model/linear/modal_truncation.h"

#include <stdlib.h>

static struct step *step_of(const char *const *argument)
{
	const struct request request = { .prefix = argument[3] };
	const struct source *source = source_read(argument[1], (struct place){ 0 });
	struct model *model = source ? model_build(parse_spec(source), &request) : NULL;
	const char *why = "the spec is wrong";
	struct modes *modes = model ? modes_of(model, &why) : NULL;
	if (!modes) {
		fprintf(stderr, "%s\n", why);
		return NULL;
	}
	bool *kept = ARRAY(bool, (size_t)modes->count);
	const int *order = modes_by_share(modes);
	for (int i = 0, weight = 0; i < modes->count && weight < atoi(argument[2]); i++) {
		kept[order[i]] = true;
		weight += modes->mode[order[i]].weight;
	}
	struct model *lost = modes_dropped(modes, kept, true);
	return lost ? step_build(lost) : NULL;
}

int main(int argc, char **argv)
{
	memory_open();
	const struct step *step = argc >= 4 ? step_of((const char *const *)argv) : NULL;
	if (step && argc == 4)
		emit_code(stdout, step, "", format("%s.h", argv[3]), false);
	else if (step)
		emit_header(stdout, step, "", false);
	diagnostics_print(stderr);
	memory_close();
	return step ? 0 : 1;
}
