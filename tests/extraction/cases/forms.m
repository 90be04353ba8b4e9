%{
@module_start
@module_name A
%}
x = y'; s = 'it''s % @module_end'; t = "% @module_end";
% @DataOut RequestWhenReady
% @Output Map
% @Input Scan, none
function [m, ok] = build(scan, ~)
  m = [1 2 ... % @module_end
       3];
end
%% @Sense NotifyAtFrequency 5
function run
(1);
end
% @DataOut RequestWhenReady
classdef B
end
% @module_end
