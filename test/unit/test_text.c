/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text of files made safe to show, and messages that are made of it. */
#include "check.h"

typedef struct pair {
    const char *text, *shown;
} pair;

static const pair spelled[] = {
    {"plain, äöü 中文 😀", "plain, äöü 中文 😀"},
    {"\x1b]0;title\a", "\\x1b]0;title\\x07"},
    {"two\nlines\r\n\tand a tab", "two\\nlines\\r\\n\\tand a tab"},
    {"\x7f", "\\x7f"},
    {"\xc2\x9b"
     "31m",
     "\\u009b31m"}, /* a control character of two bytes */
    {"\xe2\x80\xae"
     "fsg.dor",
     "\\u202efsg.dor"},                                    /* turns the text after it */
    {"\xe2\x80\xa8", "\\u2028"},                           /* a line break of Unicode */
    {"\xff\xc3\xed\xa0\x80", "\\xff\\xc3\\xed\\xa0\\x80"}, /* no UTF-8 */
    {"\xf0\x9f\x98", "\\xf0\\x9f\\x98"},                   /* cut */
    {"\xc0\xaf", "\\xc0\\xaf"},                            /* overlong */
};

static void what_steers_a_terminal_is_spelled_out(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof spelled / sizeof *spelled; i++) {
        char out[100], again[100];
        assert_true(haft_text_quote(out, sizeof out, spelled[i].text, strlen(spelled[i].text)));
        assert_string_equal(out, spelled[i].shown);
        assert_true(haft_text_quote(again, sizeof again, out, strlen(out)));
        assert_string_equal(again, out);
    }
    char small[6];
    assert_false(haft_text_quote(small, sizeof small, "abc\ndef", 7));
    assert_string_equal(small, "abc\\n");
    assert_false(haft_text_quote(small, sizeof small, "abcdä", 6)); /* not half of it */
    assert_string_equal(small, "abcd");
    assert_true(haft_text_quote(small, sizeof small, "a\0b", 0));
    assert_string_equal(small, "");
}

/* Any bytes become one line of printable characters, whatever they are. */
static void any_bytes_become_printable_text(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 2000; i++) {
        uint64_t w[4];
        char text[33] = "", out[400];
        haft_random_words((haft_random_key){31, HAFT_RANDOM_TEST}, i, 0, 0, w);
        memcpy(text, w, sizeof w);
        assert_true(haft_text_quote(out, sizeof out, text, 32));
        for (size_t at = 0; out[at] != '\0';) {
            uint32_t code = 0;
            size_t n = haft_text_character(out + at, strlen(out + at), &code);
            assert_true(n > 0 && haft_text_is_printable(code));
            at += n;
        }
    }
}

static void messages_are_made_safe(void **state) {
    (void)state;
    haft_error error = {0};
    for (size_t i = 0; i < sizeof spelled / sizeof *spelled; i++) {
        haft_error_set(&error, HAFT_ERROR_INPUT, "\"%s\" is wrong", spelled[i].text);
        haft_error_prefix(&error, "%s: ", spelled[i].text);
        char shown[200];
        snprintf(shown, sizeof shown, "%s: \"%s\" is wrong", spelled[i].shown, spelled[i].shown);
        assert_string_equal(error.message, shown);
    }
    haft_error_set(&error, HAFT_ERROR_INPUT, "first");
    assert_true(haft_error_add(&error, 0, "second: %s", "x\ny"));
    haft_error_prefix(&error, "file: ");
    assert_string_equal(error.message, "file: first\nsecond: x\\ny");
    haft_error_set(&error, HAFT_ERROR_INPUT, "%s, again", error.message); /* of itself */
    assert_string_equal(error.message, "file: first\\nsecond: x\\ny, again");
}

/* A message that is too long ends in "...", behind a whole character. */
static void long_messages_are_cut_between_characters(void **state) {
    (void)state;
    char *text = malloc(2 * HAFT_ERROR_CAPACITY + 8);
    assert_non_null(text);
    for (size_t shift = 0; shift < 3; shift++) {
        haft_error error = {0};
        memset(text, 'x', shift);
        for (size_t i = shift; i < 2 * HAFT_ERROR_CAPACITY; i += 3) {
            memcpy(text + i, "€", 4);
        }
        haft_error_set(&error, HAFT_ERROR_INPUT, "%s", text);
        size_t length = strlen(error.message);
        assert_true(length > HAFT_ERROR_CAPACITY - 8);
        assert_string_equal(error.message + length - 3, "...");
        assert_memory_equal(error.message, text, length - 3);
        assert_int_equal((length - 3 - shift) % 3, 0);
        assert_false(haft_error_add(&error, 32, "%s", text));
        assert_int_equal(strlen(error.message), length);
    }
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_steers_a_terminal_is_spelled_out),
        cmocka_unit_test(any_bytes_become_printable_text),
        cmocka_unit_test(messages_are_made_safe),
        cmocka_unit_test(long_messages_are_cut_between_characters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
