#include "outbox.h"

#include "frame.h"
#include "little_endian.h"

static void write_frame(const struct outbox *outbox, uint8_t type, uint16_t seq, const uint8_t *payload, size_t size)
{
    uint8_t wire[BP_WIRE_SIZE(BP_IDENTIFY_REPLY_SIZE)]; /* the longest message of a board */
    outbox->line->write(outbox->line->context, wire, bp_encode(type, seq, payload, size, wire));
}

void outbox_power_up(struct outbox *outbox, const struct board_line *line, const struct bp_device *self)
{
    outbox->line = line;
    outbox->self = self;
    outbox_new_session(outbox);
}

void outbox_new_session(struct outbox *outbox)
{
    outbox->telling = false;
    for (size_t i = 0; i < OUTBOX_TELEMETRY_TYPES; i++)
        outbox->counters[i] = 0;
    for (size_t i = 0; i < BP_REMEMBERED_MAX; i++)
        outbox->remembered[i].known = false;
}

const struct bp_rule *outbox_rule(const struct outbox *outbox, uint8_t request_type)
{
    const struct bp_device *self = outbox->self;
    for (size_t i = 0; i < self->rule_count; i++)
        if (self->rules[i].type == request_type)
            return &self->rules[i];
    return NULL;
}

/* Return where the last answer to a request is remembered, or NULL if it need not be. */
static struct outbox_memory *memory_of(struct outbox *outbox, uint8_t request_type)
{
    const struct bp_rule *rule = outbox_rule(outbox, request_type);
    return rule == NULL || rule->remember == BP_NOT_REMEMBERED ? NULL : &outbox->remembered[rule->remember];
}

void outbox_tell(struct outbox *outbox, uint8_t type, const uint8_t *payload, size_t size)
{
    if (outbox->telling)
        write_frame(outbox, type, outbox->counters[type - BP_TELEMETRY_START]++, payload, size);
}

static void answer(struct outbox *outbox, uint8_t request_type, uint8_t type, uint16_t seq, const uint8_t *payload,
                   size_t size)
{
    struct outbox_memory *memory = memory_of(outbox, request_type);
    write_frame(outbox, type, seq, payload, size);
    if (memory == NULL)
        return;
    memory->known = true;
    memory->pending = false;
    memory->seq = seq;
    memory->type = type;
    memory->size = (uint8_t)size;
    bp_copy(memory->payload, payload, size);
}

void outbox_reply(struct outbox *outbox, uint8_t request_type, uint16_t seq, const uint8_t *payload, size_t size)
{
    answer(outbox, request_type, (uint8_t)(request_type | BP_REPLY), seq, payload, size);
}

static void refuse(struct outbox *outbox, uint8_t request_type, uint16_t seq, uint8_t result)
{
    const struct bp_nack nack = {result, request_type};
    uint8_t payload[BP_NACK_SIZE];
    bp_pack_nack(&nack, payload);
    if (result == BP_RESULT_WRONG_STATE || result == BP_RESULT_BAD_VALUE)
        answer(outbox, request_type, BP_NACK_TYPE, seq, payload, sizeof payload);
    else /* another time, or another frame with this seq, it may be understood */
        write_frame(outbox, BP_NACK_TYPE, seq, payload, sizeof payload);
}

void outbox_result(struct outbox *outbox, uint8_t request_type, uint16_t seq, uint8_t result)
{
    const struct bp_ack ack = {BP_RESULT_OK};
    uint8_t payload[BP_ACK_SIZE];
    if (result != BP_RESULT_OK) {
        refuse(outbox, request_type, seq, result);
        return;
    }
    bp_pack_ack(&ack, payload);
    outbox_reply(outbox, request_type, seq, payload, sizeof payload);
}

void outbox_postpone(struct outbox *outbox, uint8_t request_type, uint16_t seq)
{
    struct outbox_memory *memory = memory_of(outbox, request_type);
    if (memory == NULL)
        return;
    memory->known = memory->pending = true;
    memory->seq = seq;
}

bool outbox_repeat(struct outbox *outbox, uint8_t request_type, uint16_t seq)
{
    const struct outbox_memory *memory = memory_of(outbox, request_type);
    if (memory == NULL || !memory->known || memory->seq != seq)
        return false;
    if (!memory->pending)
        write_frame(outbox, memory->type, memory->seq, memory->payload, memory->size);
    return true;
}
