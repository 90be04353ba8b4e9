x = 1; % @module_start
x = 1; % @module_name Nose
function smell = sniff(air)
end
% @module_end
%% @module_start
%% @module_name Tail
%% @ControlOut Trans_Z
function wag = decide(mood)
end
%% @module_end
