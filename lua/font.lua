-- font: letters made of strokes. Each glyph is a width and a few lines through points; a stroke that begins with ~ is a
-- smooth curve through its points. Heights: baseline 0, small letters 4, capitals 6, descenders -2.
-- The letters are those of Latin-1 and Windows-1252; accented ones are composed.
-- font.outline gives the outline of strokes drawn with a round pen: the line at half the pen's thickness from the
-- strokes, by marching squares (W. Lorensen, H. Cline, SIGGRAPH 1987, in the plane), as pieces of parabolas.
--
--   local font = require 'font'
--   local strokes, width = font.strokes 'hello'          -- lists of points
--   local contours = font.outline('a', 0.9)              -- see the module text, which makes solids of them

local check = require 'check'
local lathe = require 'lathe'

local M = {}

local glyphs = {
    A = '4;0,0 2,6 4,0;.7,2 3.3,2', B = '3.4;0,0 0,6;~0,6 1,6 2.6,5.8 3,4.6 2.4,3.4 0,3.2;~0,3.2 1,3.2 3,2.9 3.5,1.6 2.6,.2 0,0',
    C = '4;~4,5.2 2.6,6 .8,5.2 0,3 .8,.8 2.6,0 4,.8', D = '4;0,0 0,6;~0,6 2,5.8 3.7,4.6 4,3 3.7,1.4 2,.2 0,0',
    E = '3.2;3.2,6 0,6 0,0 3.2,0;0,3.1 2.6,3.1', F = '3.2;3.2,6 0,6 0,0;0,3.1 2.6,3.1',
    G = '4;~4,5.2 2.6,6 .8,5.2 0,3 .8,.8 2.3,0 3.5,.5 4,1.7;4,1.7 4,2.8 2.4,2.8', H = '3.8;0,0 0,6;3.8,0 3.8,6;0,3.1 3.8,3.1',
    I = '0;0,0 0,6', J = '2.6;~2.6,6 2.6,4 2.6,1.6 1.6,.1 .4,.3 0,1.2', K = '3.6;0,0 0,6;3.4,6 0,2.4;1.3,3.7 3.6,0',
    L = '3;0,6 0,0 3,0', M = '4.6;0,0 0,6 2.3,1.6 4.6,6 4.6,0', N = '4;0,0 0,6 4,0 4,6',
    O = '4.4;~2.2,6 .7,5.3 0,3 .7,.7 2.2,0 3.7,.7 4.4,3 3.7,5.3 2.2,6', P = '3.4;0,0 0,6;~0,6 1.4,6 3,5.6 3.5,4.4 3,3.2 1.4,2.8 0,2.8',
    Q = '4.4;~2.2,6 .7,5.3 0,3 .7,.7 2.2,0 3.7,.7 4.4,3 3.7,5.3 2.2,6;2.8,1.5 4.5,-.4',
    R = '3.6;0,0 0,6;~0,6 1.4,6 3,5.6 3.4,4.4 3,3.3 1.4,2.9 0,2.9;1.7,2.9 3.6,0',
    S = '3.6;~3.4,5.1 2.4,6 1,5.9 .2,4.8 .6,3.6 2,3 3.2,2.3 3.5,1.2 2.6,.1 1.1,0 0,.9', T = '4;0,6 4,6;2,6 2,0',
    U = '3.8;~0,6 0,4 0,2.2 .5,.6 1.9,0 3.3,.6 3.8,2.2 3.8,4 3.8,6', V = '4;0,6 2,0 4,6', W = '5.4;0,6 1.4,0 2.7,5 4,0 5.4,6',
    X = '3.8;0,0 3.8,6;0,6 3.8,0', Y = '3.8;0,6 1.9,3 3.8,6;1.9,3 1.9,0', Z = '3.6;0,6 3.6,6 0,0 3.6,0',
    a = '2.8;~2.8,3.4 1.5,4 .3,3.1 0,1.8 .4,.5 1.4,0 2.4,.7 2.8,1.8;2.8,4 2.8,0', b = '2.8;0,6 0,0;~0,2.2 .6,3.5 1.6,4 2.6,3.2 2.9,2 2.5,.6 1.5,0 .5,.5 0,1.6',
    c = '2.6;~2.6,3.3 1.6,4 .5,3.4 0,2 .5,.6 1.6,0 2.6,.6', d = '2.8;2.8,6 2.8,0;~2.8,2.2 2.2,3.5 1.3,4 .3,3.2 0,2 .4,.6 1.4,0 2.3,.5 2.8,1.6',
    e = '2.8;~.05,2.1 1.4,2.2 2.8,2.3 2.4,3.6 1.4,4 .4,3.4 0,2 .5,.5 1.6,0 2.7,.7', f = '2;~2,5.7 1.2,6 .7,5 .7,3 .7,0;0,3.8 1.8,3.8',
    g = '2.8;~2.8,3.4 1.5,4 .3,3.1 0,2 .4,.7 1.4,.2 2.4,.9 2.8,2;~2.8,4 2.8,1 2.7,-1 1.6,-2 .2,-1.4', h = '2.7;0,6 0,0;~0,2.4 .7,3.6 1.7,4 2.6,3.2 2.7,1.6 2.7,0',
    i = '0;0,4 0,0;0,5.5 0,5.6', j = '.8;~.8,4 .8,1 .8,-1 0,-1.9;.8,5.5 .8,5.6', k = '2.6;0,6 0,0;2.4,4 0,1.6;.9,2.4 2.6,0', l = '0;0,6 0,0',
    m = '4.4;0,4 0,0;~0,2.6 .5,3.6 1.3,4 2.1,3.3 2.2,1.6 2.2,0;~2.2,2.6 2.7,3.6 3.5,4 4.3,3.3 4.4,1.6 4.4,0',
    n = '2.7;0,4 0,0;~0,2.4 .7,3.6 1.7,4 2.6,3.2 2.7,1.6 2.7,0', o = '2.9;~1.45,4 .4,3.4 0,2 .4,.6 1.45,0 2.5,.6 2.9,2 2.5,3.4 1.45,4',
    p = '2.8;0,4 0,-2;~0,2.2 .6,3.5 1.6,4 2.6,3.2 2.9,2 2.5,.6 1.5,0 .5,.5 0,1.6', q = '2.8;2.8,4 2.8,-2;~2.8,2.2 2.2,3.5 1.3,4 .3,3.2 0,2 .4,.6 1.4,0 2.3,.5 2.8,1.6',
    r = '1.8;0,4 0,0;~0,2.2 .4,3.4 1.1,4 1.8,3.8', s = '2.3;~2.2,3.4 1.2,4 .3,3.5 .4,2.5 1.3,2.1 2.2,1.6 2.2,.6 1.2,0 0,.6',
    t = '2;~.7,5.4 .7,3 .7,1 1.2,0 2,.3;0,3.9 1.8,3.9', u = '2.7;~0,4 0,2.2 .2,.6 1.1,0 2.1,.6 2.7,1.8;2.7,4 2.7,0', v = '2.8;0,4 1.4,0 2.8,4',
    w = '4;0,4 1,0 2,3.4 3,0 4,4', x = '2.6;0,0 2.6,4;0,4 2.6,0', y = '2.8;0,4 1.5,.2;~2.8,4 1.5,.2 .9,-1.3 0,-1.9', z = '2.5;0,4 2.5,4 0,0 2.5,0',
    ['0'] = '3;~1.5,6 .4,5.2 0,3 .4,.8 1.5,0 2.6,.8 3,3 2.6,5.2 1.5,6', ['1'] = '1.2;0,4.8 1.2,6 1.2,0',
    ['2'] = '3;~.1,4.7 .7,5.7 1.7,6 2.7,5.4 2.8,4.2 1.8,2.4 0,0;0,0 3,0', ['3'] = '3;~.2,5.3 1.4,6 2.6,5.3 2.5,3.9 1.2,3.2;~1.2,3.2 2.7,2.7 3,1.4 1.7,0 0,.8',
    ['4'] = '3.2;2.4,0 2.4,6 0,1.8 3.2,1.8', ['5'] = '3;2.7,6 .5,6 .2,3.2;~.2,3.2 1.5,3.7 2.8,2.9 2.9,1.3 1.7,.1 0,.6',
    ['6'] = '3;~2.6,5.6 1.4,5.8 .3,4 0,1.9 .6,.4 1.6,0 2.8,.8 2.9,2.4 1.8,3.5 .6,3 0,1.9', ['7'] = '3;0,6 3,6 1,0',
    ['8'] = '3;~1.5,3.2 .3,4 .3,5.3 1.5,6 2.7,5.3 2.7,4 1.5,3.2 0,2.2 .1,.7 1.5,0 2.9,.7 3,2.2 1.5,3.2',
    ['9'] = '3;~3,4.1 2.4,3 1.2,2.5 .1,3.6 .2,5.2 1.4,6 2.4,5.6 3,4.1 2.7,2 1.6,.2 .4,.4',
    ['.'] = '0;0,0 0,.1', [','] = '.3;.3,.2 0,-.9', ["'"] = '.3;.3,6 0,4.8', ['-'] = '1.8;0,2.5 1.8,2.5', ['!'] = '0;0,6 0,1.7;0,0 0,.1',
    ['?'] = '2.6;~0,5 .8,6 2.1,5.8 2.6,4.7 1.8,3.4 1.3,2.6 1.3,1.7;1.3,0 1.3,.1', [':'] = '0;0,0 0,.1;0,3 0,3.1', ['/'] = '2.4;0,-.6 2.4,6.4', ['+'] = '2.8;0,2.5 2.8,2.5;1.4,1.1 1.4,3.9',
    ['"'] = '1.5;0,6 0,4.8;1.5,6 1.5,4.8', ['#'] = '3.8;.8,0 1.4,6;2.4,0 3,6;0,1.9 3.6,1.9;.2,4.1 3.8,4.1', ['('] = '1.2;~1.2,6.6 .3,5 0,3 .3,1 1.2,-.6',
    [')'] = '1.2;~0,6.6 .9,5 1.2,3 .9,1 0,-.6', ['*'] = '2.4;1.2,6.2 1.2,3.4;0,5.5 2.4,4.1;0,4.1 2.4,5.5', [';'] = '.3;.3,3 .3,3.1;.3,.2 0,-.9',
    ['<'] = '2.6;2.6,4.4 0,2.5 2.6,.6', ['='] = '2.8;0,3.3 2.8,3.3;0,1.7 2.8,1.7', ['>'] = '2.6;0,4.4 2.6,2.5 0,.6', ['['] = '1.2;1.2,6.6 0,6.6 0,-.6 1.2,-.6',
    ['@'] = '6;~4,3.3 3.1,4.2 2.1,3.6 1.8,2.4 2.5,1.5 3.5,1.9 4,3.3;~4.1,4.1 4,2.6 4.3,1.6 5.2,1.6 5.9,2.7 5.8,4.2 4.7,5.6 2.9,6 1,5.1 0,2.9 .8,.6 2.8,-.5 4.7,.0',
    ['\\'] = '2.4;0,6.4 2.4,-.6', [']'] = '1.2;0,6.6 1.2,6.6 1.2,-.6 0,-.6', ['^'] = '2.4;0,4.2 1.2,6 2.4,4.2', ['_'] = '3.4;0,-1 3.4,-1', ['|'] = '0;0,6.6 0,-.8',
    ['{'] = '1.6;~1.6,6.6 .9,6.2 .8,5 .7,3.5 0,3;~0,3 .7,2.5 .8,1 .9,-.2 1.6,-.6', ['}'] = '1.6;~0,6.6 .7,6.2 .8,5 .9,3.5 1.6,3;~1.6,3 .9,2.5 .8,1 .7,-.2 0,-.6',
    ['~'] = '3;~0,2.1 .8,2.9 2.2,2.1 3,2.9', ['&'] = '4;~4,0 2.4,1.8 .9,3.8 .6,5 1.1,5.8 1.9,6 2.6,5.2 2.2,4.1 .8,2.9 .1,1.7 .5,.5 1.6,0 2.9,.6 3.8,2.5',
    ['¡'] = '0;0,2.3 0,-2;0,3.9 0,4', ['¿'] = '2.6;~2.6,-1 1.8,-2 .5,-1.8 0,-.7 .8,.6 1.3,1.4 1.3,2.3;1.3,3.9 1.3,4', ['¦'] = '0;0,6.6 0,4;0,1.8 0,-.8',
    ['£'] = '3.4;~3.2,5 2.5,6 1.4,5.8 .9,4.6 1,2.6 .8,.9 0,0;0,0 3.4,0;0,3 2.4,3', ['€'] = '4.2;~4.2,5.3 3,6 1.6,5.2 .9,3 1.6,.8 3,0 4.2,.7;0,3.8 3,3.8;0,2.2 2.8,2.2',
    ['¤'] = '3.6;~1.8,1.7 .5,3 1.8,4.3 3.1,3 1.8,1.7;0,1.2 .8,2;3.6,1.2 2.8,2;0,4.8 .8,4;3.6,4.8 2.8,4',
    ['§'] = '2.8;~2.5,5.4 1.4,6 .4,5.2 .7,4.3 2,3.5 2.8,2.5 2,1.5;~.8,4 0,3 .8,2 2.1,1.2 2.4,.2 1.4,-.6 .3,0',
    ['©'] = '6.4;~3.2,-.2 .9,.7 0,3 .9,5.3 3.2,6.2 5.5,5.3 6.4,3 5.5,.7 3.2,-.2;~4.4,3.9 3.3,4.5 2.1,3.8 1.8,3 2.1,2.2 3.3,1.5 4.4,2.1',
    ['®'] = '6.4;~3.2,-.2 .9,.7 0,3 .9,5.3 3.2,6.2 5.5,5.3 6.4,3 5.5,.7 3.2,-.2;2.2,1.4 2.2,4.6;~2.2,4.6 3.4,4.6 4.2,3.8 3.4,3 2.2,2.9;3.1,2.9 4.2,1.4',
    ['¬'] = '2.8;0,3 2.8,3 2.8,1.4', ['°'] = '1.8;~.9,4.2 .26,4.46 0,5.1 .26,5.74 .9,6 1.54,5.74 1.8,5.1 1.54,4.46 .9,4.2', ['±'] = '2.8;0,3 2.8,3;1.4,4.4 1.4,1.6;0,0 2.8,0', ['·'] = '0;0,2.5 0,2.6',
    ['µ'] = '2.7;0,4 0,-2;~0,2.2 .2,.6 1.1,0 2.1,.6 2.7,1.8;2.7,4 2.7,0', ['¶'] = '3.2;3.2,6 3.2,-1;1.7,6 1.7,-1;~3.2,6 1.3,6 .1,5.3 .1,3.8 1.2,3 1.7,3',
    ['«'] = '2.9;1.2,3.6 0,2 1.2,.4;2.9,3.6 1.7,2 2.9,.4', ['»'] = '2.9;0,3.6 1.2,2 0,.4;1.7,3.6 2.9,2 1.7,.4', ['‹'] = '1.2;1.2,3.6 0,2 1.2,.4', ['›'] = '1.2;0,3.6 1.2,2 0,.4',
    ['×'] = '2.2;0,1.4 2.2,3.6;0,3.6 2.2,1.4', ['÷'] = '2.8;0,2.5 2.8,2.5;1.4,4.2 1.4,4.3;1.4,.7 1.4,.8', ['−'] = '2.8;0,2.5 2.8,2.5', ['–'] = '3;0,2.5 3,2.5',
    ['—'] = '5;0,2.5 5,2.5', ['‘'] = '.4;0,6 .4,4.8', ['’'] = '.4;.4,6 0,4.8', ['‚'] = '.3;.3,.2 0,-.9', ['“'] = '1.9;0,6 .4,4.8;1.5,6 1.9,4.8',
    ['”'] = '1.9;.4,6 0,4.8;1.9,6 1.5,4.8', ['„'] = '1.8;.3,.2 0,-.9;1.8,.2 1.5,-.9', ['…'] = '3.2;0,0 0,.1;1.6,0 1.6,.1;3.2,0 3.2,.1', ['•'] = '.7;~.35,2.1 0,2.5 .35,2.9 .7,2.5 .35,2.1',
    ['Æ'] = '5.4;0,0 2.6,6 5.4,6;2.6,6 2.6,0 5.4,0;2.6,3.1 4.9,3.1;.8,1.9 2.6,1.9', ['Œ'] = '5.8;~3,6 2,6 .7,5.2 0,3 .7,.8 2,0 3,0;5.8,6 3,6 3,0 5.8,0;3,3.1 5.2,3.1',
    ['Þ'] = '3.4;0,0 0,6;~0,4.7 1.4,4.7 3,4.3 3.5,3 3,1.8 1.4,1.4 0,1.4', ['þ'] = '2.8;0,6 0,-2;~0,2.2 .6,3.5 1.6,4 2.6,3.2 2.9,2 2.5,.6 1.5,0 .5,.5 0,1.6',
    ['ß'] = '3;~0,0 0,3 0,4.6 .5,5.7 1.5,6 2.5,5.3 2.4,4.1 1.3,3.3;~1.3,3.3 2.7,2.6 3,1.4 2.4,.2 1.2,.1', ['ı'] = '0;0,4 0,0',
    ['†'] = '2.6;1.3,6 1.3,-1;0,4.2 2.6,4.2', ['‡'] = '2.6;1.3,6 1.3,-1;0,4.2 2.6,4.2;0,.8 2.6,.8', ['ƒ'] = '3;~3,5.7 2.2,6 1.7,5 1.4,3 1.2,0 .8,-1.6 0,-1.8;.4,3.6 2.6,3.6',
    -- accents, as they stand above a small letter (the cedilla below)
    ['`'] = '.9;0,5.9 .9,4.9', ['´'] = '.9;.9,5.9 0,4.9', ['ˆ'] = '1.6;0,4.9 .8,5.9 1.6,4.9', ['ˇ'] = '1.6;0,5.9 .8,4.9 1.6,5.9', ['¨'] = '1.5;0,5.5 0,5.6;1.5,5.5 1.5,5.6',
    ['˜'] = '2;~0,5.1 .5,5.6 1.5,5 2,5.5', ['˚'] = '1.5;~.75,4.95 .22,5.17 0,5.7 .22,6.23 .75,6.45 1.28,6.23 1.5,5.7 1.28,5.17 .75,4.95', ['¯'] = '1.8;0,5.4 1.8,5.4', ['¸'] = '1;~.6,0 1,-.9 .6,-1.8 0,-1.7',
    ['è'] = '2.8;~.05,2.1 1.4,2.2 2.8,2.3 2.4,3.6 1.4,4 .4,3.4 0,2 .5,.5 1.6,0 2.7,.7;.8,5.9 1.7,4.9',
    ['é'] = '2.8;~.05,2.1 1.4,2.2 2.8,2.3 2.4,3.6 1.4,4 .4,3.4 0,2 .5,.5 1.6,0 2.7,.7;2.0,5.9 1.1,4.9',
}

--- The strokes of a letter, scaled and moved.
local function moved(letter, factor, dx, dy)
    return (glyphs[letter]:match(';(.*)$'):gsub('([%-%d.]+),([%-%d.]+)', function(x, y)
        return ('%.3f,%.3f'):format(x * factor + dx, y * factor + dy)
    end))
end

-- letters of other letters and a few strokes more
for letter, parts in pairs { ['$'] = 'S;1.8,-.9 1.8,6.9', ['¢'] = 'c;1.5,-.9 1.5,4.9', ['¥'] = 'Y;.5,2.8 3.3,2.8;.5,1.2 3.3,1.2', ['Ð'] = 'D;-.7,3.1 1.7,3.1',
                             ['ð'] = 'o;~.5,6.2 1.9,5.3 2.8,3.7 2.9,2;.8,4.9 2.5,5.9', ['Ø'] = 'O;.4,-.4 4,6.4', ['ø'] = 'o;.2,-.5 2.7,4.5' } do
    local base, more = parts:match '^(.-)(;.*)$'
    glyphs[letter] = glyphs[base] .. more
end
glyphs['æ'] = '5.4;' .. moved('a', 1, 0, 0) .. ';' .. moved('e', 1, 2.6, 0)
glyphs['œ'] = '5.5;' .. moved('o', 1, 0, 0) .. ';' .. moved('e', 1, 2.7, 0)
glyphs['%'] = '5.2;' .. moved('o', .6, 0, 3.6) .. ';1.1,0 4.1,6;' .. moved('o', .6, 3.5, 0)
glyphs['‰'] = '8;' .. moved('o', .6, 0, 3.6) .. ';1.1,0 4.1,6;' .. moved('o', .6, 3.5, 0) .. ';' .. moved('o', .6, 6.3, 0)
glyphs['ª'], glyphs['º'] = '1.7;' .. moved('a', .6, 0, 3.6) .. ';0,1.9 1.7,1.9', '1.7;' .. moved('o', .6, 0, 3.6) .. ';0,1.9 1.7,1.9'
for letter, digit in pairs { ['¹'] = '1', ['²'] = '2', ['³'] = '3' } do
    glyphs[letter] = (digit == '1' and '.7;' or '1.7;') .. moved(digit, .57, 0, 2.6)
end
for letter, digits in pairs { ['¼'] = '14', ['½'] = '12', ['¾'] = '34' } do
    glyphs[letter] = '6;' .. moved(digits:sub(1, 1), .57, 0, 2.6) .. ';1.3,-.2 4.5,6.2;' .. moved(digits:sub(2), .57, 4.2, 0)
end
glyphs['™'] = '6;' .. moved('T', .5, 0, 3) .. ';' .. moved('M', .5, 3.4, 3)
glyphs['\u{ad}'] = glyphs['-'] -- the soft hyphen

-- Accented letters, their letter and the accent, which is centred; capitals are 2 higher than small letters.
for letter, base, accent in ('ÀA` ÁA´ ÂAˆ ÃA˜ ÄA¨ ÅA˚ ÇC¸ ÈE` ÉE´ ÊEˆ ËE¨ ÌI` ÍI´ ÎIˆ ÏI¨ ÑN˜ ÒO` ÓO´ ÔOˆ ÕO˜ ÖO¨ ÙU` ÚU´ ÛUˆ ÜU¨ ÝY´ ŸY¨ ŠSˇ ŽZˇ ' ..
    'àa` áa´ âaˆ ãa˜ äa¨ åa˚ çc¸ êeˆ ëe¨ ìı` íı´ îıˆ ïı¨ ñn˜ òo` óo´ ôoˆ õo˜ öo¨ ùu` úu´ ûuˆ üu¨ ýy´ ÿy¨ šsˇ žzˇ'):gmatch '([\xc2-\xcf].)([A-Za-z\xc4]\xb1?)(%S+)' do
    local own, above = tonumber(glyphs[base]:match '^[^;]+'), tonumber(glyphs[accent]:match '^[^;]+')
    local width, rise = math.max(own, above), base:match '%u' and accent ~= '¸' and 2 or 0
    glyphs[letter] = width .. ';' .. moved(base, 1, (width - own) / 2, 0) .. ';' .. moved(accent, 1, (width - above) / 2, rise)
end

local STEPS <const> = 16 -- pieces between two points

--- The curve through the points; its ends bend half as much as the pieces beside them.
local function smooth(points, ring)
    if ring or #points < 3 then
        local curve = lathe.spline(points, STEPS, ring)
        if ring then curve[#curve + 1] = curve[1] end
        return curve
    end
    local function beyond(p, q, r) return { 2.5 * p[1] - 2 * q[1] + r[1] / 2, 2.5 * p[2] - 2 * q[2] + r[2] / 2 } end
    local n = #points
    local longer = table.move(points, 1, n, 2, { beyond(points[1], points[2], points[3]) })
    longer[n + 2] = beyond(points[n], points[n - 1], points[n - 2])
    return table.move(lathe.spline(longer, STEPS), STEPS + 1, n * STEPS + 1, 1, {})
end

local cache = {}

local function glyph(letter)
    local known = cache[letter]
    if known then return known end
    local text = glyphs[letter]
    if not text then return nil end
    local width, rest = text:match('^([^;]+);(.*)$')
    local made = { width = tonumber(width), strokes = {} }
    for stroke in rest:gmatch('[^;]+') do
        local points = {}
        for x, y in stroke:gmatch('([%-%d%.]+),([%-%d%.]+)') do points[#points + 1] = { tonumber(x), tonumber(y) } end
        if stroke:sub(1, 1) == '~' then
            local first, last = points[1], points[#points]
            local ring = #points > 3 and first[1] == last[1] and first[2] == last[2]
            if ring then points[#points] = nil end
            points = smooth(points, ring)
        end
        made.strokes[#made.strokes + 1] = points
    end
    cache[letter] = made
    return made
end

--- The strokes of a line of text, starting at the origin, and its width. One unit is a sixth of a capital.
---@param text string  UTF-8; letters the font does not have are left blank, with a warning
---@return number[][][] strokes  lists of points {x, y}
---@return number width
function M.strokes(text)
    local out, x = {}, 0
    M.warn_of_missing(text)
    for _, code in utf8.codes(text) do
        local shape = glyph(utf8.char(code))
        if shape then
            for _, points in ipairs(shape.strokes) do
                local moved = {}
                for i, p in ipairs(points) do moved[i] = { p[1] + x, p[2] } end
                out[#out + 1] = moved
            end
            x = x + shape.width + 1.5
        else
            x = x + 3
        end
    end
    return out, math.max(0, x - 1.5)
end

--- One warning that names the letters of a text that the font does not have; none for blanks and line ends.
---@param text string
function M.warn_of_missing(text)
    local missing, is_known, count = {}, {}, 0
    for _, code in utf8.codes(text) do
        local letter = utf8.char(code)
        if code > 32 and code ~= 160 and not glyphs[letter] and not is_known[code] then
            is_known[code], count = true, count + 1
            if count <= 8 then missing[count] = '"' .. letter .. '"' end
        end
    end
    if count == 0 then return end
    warn('the built-in font has no letter for ', table.concat(missing, ', '), count > 8 and ' and ' .. count - 8 .. ' others' or '')
end

--- Letters the font has, in the order of their codes.
---@return string[]
function M.letters()
    local out = {}
    for letter in pairs(glyphs) do out[#out + 1] = letter end
    table.sort(out, function(a, b) return utf8.codepoint(a) < utf8.codepoint(b) end)
    return out
end

local sqrt, max, min, abs = math.sqrt, math.max, math.min, math.abs

--- The distance to the strokes minus half the weight, as a function.
local function field_of(strokes, weight)
    local segments = {}
    for _, points in ipairs(strokes) do
        for i = 1, max(1, #points - 1) do
            local a, b = points[i], points[i + 1] or points[i]
            local dx, dy = b[1] - a[1], b[2] - a[2]
            local squared = dx * dx + dy * dy
            segments[#segments + 1] = { a[1], a[2], dx, dy, squared > 0 and 1 / squared or 0 }
        end
    end
    return function(x, y)
        local least = math.huge
        for i = 1, #segments do
            local s = segments[i]
            local px, py = x - s[1], y - s[2]
            local t = (px * s[3] + py * s[4]) * s[5]
            t = t < 0 and 0 or t > 1 and 1 or t
            px, py = px - t * s[3], py - t * s[4]
            local d = px * px + py * py
            if d < least then least = d end
        end
        return sqrt(least) - weight / 2
    end
end

--- The zero lines of a field by marching squares, each point moved onto the line along the gradient; the inside is
--- on the left.
local function iso_lines(field, x0, y0, x1, y1, step)
    local nx, ny = math.ceil((x1 - x0) / step), math.ceil((y1 - y0) / step)
    local value = {}
    for j = 0, ny do
        local i, row = 0, j * (nx + 1)
        while i <= nx do
            local v = field(x0 + i * step, y0 + j * step)
            -- a distance function has slope 1 at most: its sign is constant within that distance
            local known = max(0, math.ceil(abs(v) / step) - 2)
            for k = i, min(nx, i + known) do value[row + k] = v end
            i = i + known + 1
        end
    end
    -- a crossing on the edge from one lattice point to the next in x (odd keys) or y (even keys) -> the next crossing
    local follow, place = {}, {}
    local function crossing(i, j, up)
        local a = j * (nx + 1) + i
        local b = up and a + nx + 1 or a + 1
        local key = 2 * a + (up and 0 or 1)
        if not place[key] then
            local t = value[a] / (value[a] - value[b])
            local x, y = x0 + (i + (up and 0 or t)) * step, y0 + (j + (up and t or 0)) * step
            for _ = 1, 3 do
                local d, h = field(x, y), step * 1e-3
                local gx, gy = (field(x + h, y) - field(x - h, y)) / (2 * h), (field(x, y + h) - field(x, y - h)) / (2 * h)
                local squared = gx * gx + gy * gy
                if squared > 0.25 then x, y = x - d * gx / squared, y - d * gy / squared end
            end
            place[key] = { x, y }
        end
        return key
    end
    for j = 0, ny - 1 do
        for i = 0, nx - 1 do
            local a = j * (nx + 1) + i
            local s, e, n, w = value[a] < 0, value[a + 1] < 0, value[a + nx + 2] < 0, value[a + nx + 1] < 0
            -- corners counter-clockwise: s, e, n, w; the line leaves through an edge that goes from inside to outside
            local ins, outs = {}, {}
            local function edge(from, to, key)
                if from and not to then outs[#outs + 1] = key() elseif to and not from then ins[#ins + 1] = key() end
            end
            edge(s, e, function() return crossing(i, j, false) end)
            edge(e, n, function() return crossing(i + 1, j, true) end)
            edge(n, w, function() return crossing(i, j + 1, false) end)
            edge(w, s, function() return crossing(i, j, true) end)
            if #ins == 1 then
                follow[outs[1]] = ins[1]
            elseif #ins == 2 then -- two diagonal corners: the centre decides which are connected
                local middle = field(x0 + (i + 0.5) * step, y0 + (j + 0.5) * step) < 0
                local same = s == middle
                if same then follow[outs[1]], follow[outs[2]] = ins[1], ins[2] else follow[outs[1]], follow[outs[2]] = ins[2], ins[1] end
            end
        end
    end
    local lines, keys = {}, {}
    for key in pairs(follow) do keys[#keys + 1] = key end
    table.sort(keys)
    for _, start in ipairs(keys) do
        if follow[start] then
            local line, key = {}, start
            while key and follow[key] do
                local p, last = place[key], line[#line]
                if not last or abs(p[1] - last[1]) + abs(p[2] - last[2]) > 0.05 * step then line[#line + 1] = p end
                follow[key], key = nil, follow[key]
            end
            if #line > 2 then lines[#lines + 1] = line end
        end
    end
    return lines
end

--- A closed line as pieces of parabolas: { x, y, control x, control y } each, up to the start of the next one.
local function parabolas(line, tolerance)
    local n, pieces = #line, {}
    local function at(k) return line[(k - 1) % n + 1] end
    local function direction(a, b)
        local x, y = b[1] - a[1], b[2] - a[2]
        local length = sqrt(x * x + y * y)
        return x / length, y / length
    end
    local corners = {}
    for k = 1, n do
        local ux, uy = direction(at(k - 1), at(k))
        local vx, vy = direction(at(k), at(k + 1))
        local turn = ux * vx + uy * vy
        if turn < 0.88 then corners[#corners + 1] = k end
    end
    local is_corner = {}
    for _, k in ipairs(corners) do is_corner[k] = true end
    if #corners == 0 then corners = { 1 } end
    local function tangent(k, ahead) -- along the line; at a corner, that of the requested side
        local wrapped = (k - 1) % n + 1
        if is_corner[wrapped] then
            if ahead then return direction(at(k), at(k + 1)) end
            return direction(at(k - 1), at(k))
        end
        return direction(at(k - 1), at(k + 1))
    end
    local function fit(i, j)
        local a, b = at(i), at(j)
        local ux, uy = tangent(i, true)
        local vx, vy = tangent(j, false)
        local dx, dy, det = b[1] - a[1], b[2] - a[2], ux * vy - uy * vx
        local cx, cy = (a[1] + b[1]) / 2, (a[2] + b[2]) / 2
        local along = det ~= 0 and (dx * vy - dy * vx) / det or -1
        local back = det ~= 0 and (dx * uy - dy * ux) / det or 1
        local length = sqrt(dx * dx + dy * dy)
        if along > 0 and back < 0 and ux * vx + uy * vy > 0.3 and along < 2 * length then cx, cy = a[1] + along * ux, a[2] + along * uy end
        local worst = ux * vx + uy * vy > 0.3 and 0 or j - i > 2 and math.huge or 0
        for k = i + 1, j - 1 do
            local p, least = at(k), math.huge
            for s = 0, 12 do
                local t = s / 12
                local x = (1 - t) ^ 2 * a[1] + 2 * t * (1 - t) * cx + t * t * b[1]
                local y = (1 - t) ^ 2 * a[2] + 2 * t * (1 - t) * cy + t * t * b[2]
                least = min(least, (p[1] - x) ^ 2 + (p[2] - y) ^ 2)
            end
            -- between two of the thirteen points the parabola may be nearer, by less than half their distance
            worst = max(worst, sqrt(least) - length / 26)
        end
        if worst > tolerance and j - i > 1 then
            local middle = (i + j) // 2
            fit(i, middle)
            fit(middle, j)
        else
            pieces[#pieces + 1] = { a[1], a[2], cx, cy }
        end
    end
    for c, k in ipairs(corners) do
        local last = corners[c + 1] or corners[1] + n
        -- no piece longer than a quarter of the line, so that rings have four
        local parts = max(1, math.ceil((last - k) / (n / 4) - 1e-9))
        for part = 1, parts do fit(k + (last - k) * (part - 1) // parts, k + (last - k) * part // parts) end
    end
    return pieces
end

local outlines = {}

--- The outline of a letter drawn with a round pen, in the units of the strokes (a capital is 6 high, without the pen).
---@param letter string
---@param weight number?  thickness of the pen, default 0.9
---@return number[][][]|nil contours  pieces of parabolas { x, y, control x, control y }, inside on the left; nil when the
---  font has no such letter
---@return number width  of the strokes
function M.outline(letter, weight)
    check.text('font.outline', 'letter', letter)
    weight = check.number('font.outline', 'weight', weight, 0.1, 2, 0.9)
    local shape = glyph(letter)
    if not shape then return nil, 0 end
    local key = letter .. weight
    if not outlines[key] then
        local reach, x0, y0, x1, y1 = weight / 2 + 0.2, math.huge, math.huge, -math.huge, -math.huge
        for _, points in ipairs(shape.strokes) do
            for _, p in ipairs(points) do x0, y0, x1, y1 = min(x0, p[1]), min(y0, p[2]), max(x1, p[1]), max(y1, p[2]) end
        end
        local contours, step = {}, min(0.11, weight / 6)
        -- an irregular lattice, so that no letter coincides with it
        local field = field_of(shape.strokes, weight)
        for k, line in ipairs(iso_lines(field, x0 - reach - 0.0137, y0 - reach - 0.0091, x1 + reach, y1 + reach, step)) do
            contours[k] = parabolas(line, 0.012)
        end
        outlines[key] = contours
    end
    return outlines[key], shape.width
end

return M
