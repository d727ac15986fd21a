!> Explanations of what a run says about its increments.
module lopin_explain_time
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: time_explanations

contains

   subroutine time_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'N0550', 'increments end at the points of amplitudes', &
         & 'Friction, flow and contact that sticks remember the way that loads and motions '// &
         & 'took. So an increment ends at every point of an amplitude in use, DIRECT or not; '// &
         & 'fixed increments go on in their places after it. INC= does not count these.', &
         & 'nothing to do; a scene without history keeps the increments that are given.')
      call add_explanation(list, 'E0550', 'a body passes through another within an increment', &
         & 'Contact is looked for where bodies and tools stand at the end of an increment. '// &
         & 'Here a point of the slave was in front of its master at the start, behind it on '// &
         & 'the way, and at the end the contact knows nothing of it: the motion of the '// &
         & 'increment jumps over what lies in its way. Increments that may be cut are; with '// &
         & 'DIRECT, or at the smallest increment, the run stops.', &
         & 'smaller increments on *STATIC, no longer than half of the thinner body or tool.')
      call add_explanation(list, 'W0550', 'a point went through its master and came out', &
         & 'The straight way of a point between the ends of a DIRECT increment leads deep '// &
         & 'through its master, as across the corner of a tool, and it meets the master again '// &
         & 'at the end. What lay between was not followed.', &
         & 'smaller increments on *STATIC.')
      call add_explanation(list, 'E0551', 'a body that friction holds jumps', &
         & 'Nothing but friction holds the body, all its points slipped in an iteration, and '// &
         & 'the balance that Newton found lies far from where the body was: several times '// &
         & 'farther than anything is prescribed to move. Friction knows nothing of such a way. '// &
         & 'Increments that may be cut are; otherwise the run stops.', &
         & 'smaller increments on *STATIC; more friction, if it is too little to hold the '// &
         & 'body; or hold the motion by *BOUNDARY.')
      call friction_explanations(list)
   end subroutine time_explanations

   !> What friction and metal remember of an increment.
   subroutine friction_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0559', 'much flow where a part of a run begins', &
         & 'A part begins on a mesh that is not in balance: elements have been taken out, and '// &
         & 'what they held is let go of while nothing moves. Metal beside them flows more in '// &
         & 'that one increment than increments should.', &
         & 'finer elements where metal separates.')
      call add_explanation(list, 'E0555', 'contact forces pass to other points in one increment', &
         & 'Within an increment in which metal flows, points close or open or go round a '// &
         & 'corner of the tool, and more than a tenth of the contact force with them. Metal '// &
         & 'remembers when that was, but an increment knows its end alone. It is cut, unless '// &
         & 'the metal flows by less than five strains of first yield; points by metal that '// &
         & 'flows less than that count in proportion. So are increments in which points leave '// &
         & 'that carried a tenth of the largest force of the run and rubbed, or held a body '// &
         & 'that floats then. What jumps in any increment is taken as it is.', &
         & 'smaller increments on *STATIC; DIRECT takes them as they are (W0555).')
      call add_explanation(list, 'W0555', 'contact forces pass to other points in one increment', &
         & 'As E0555, in increments that may not be cut, and more than a quarter of the force: '// &
         & 'polygons pressed into metal were then up to 16 % off in their forces.', &
         & 'smaller increments on *STATIC, or increments without DIRECT.')
      call rate_explanations(list)
   end subroutine friction_explanations

   !> What metal that looks at the rate sees of an increment, and what slides on turning tools.
   subroutine rate_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0556', 'increments long for metal that looks at the rate', &
         & 'An increment knows the mean rate of its strain, and its stress is that of '// &
         & 'the mean. Where tools move steadily, the rate at the end of an increment that '// &
         & 'strains by e is higher by the share e/2 than the mean, and a stress that goes as '// &
         & 'rate^m is m e/2 too low. It is the mean over what flows, weighted by its work, and '// &
         & 'told from 5 % on. Where the rate itself is kept there is no such error.', &
         & 'smaller increments on *STATIC, until m e/2 is below what is asked for.')
      call add_explanation(list, 'E0567', 'loads drive metal too far in one increment', &
         & 'As W0567, but where the increment may be cut, and is.', &
         & 'smaller increments on *STATIC (fourth number).')
      call add_explanation(list, 'W0567', 'loads drive metal whose rate follows the stress', &
         & 'Under a given load the stress of a viscous metal is given, and with it its rate. '// &
         & 'An increment flows as fast as the rate at its end says, which is too far while '// &
         & 'loads grow: by half of what the plastic power rises in it, times its length. '// &
         & 'Summed up over the run, beside all plastic work, and told from 5 % on (a block '// &
         & 'pressed by a force that rose to its end in 3 increments was pressed by 20 % too '// &
         & 'far). Increments are kept as short as leaves that at some 5 % where metal of '// &
         & 'm = .145 is pressed by a force that rises from nothing; DIRECT takes them as '// &
         & 'they are.', &
         & 'smaller increments on *STATIC (fourth number): half of them leave half; or move '// &
         & 'the tool by its displacement.')
      call add_explanation(list, 'E0553', 'a tool turns far below what slides on it', &
         & 'On the present shape the slip of an increment is the straight way on the tool from '// &
         & 'where a point was to where it is. Below a point that stands still a tool that '// &
         & 'turns draws an arc. Increments that may be cut are, to 6 degrees: shears are then '// &
         & 'off by 3 degrees at most, torques by .14 %.', &
         & 'smaller increments on *STATIC.')
      call add_explanation(list, 'W0553', 'a tool turns far below what slides on it', &
         & 'As E0553, where increments may not be cut (DIRECT). A tool that turns by t in an '// &
         & 'increment shears what stands still off its way by t/2, and after a full turn '// &
         & 'nothing seems to have slid.', &
         & 'increments of 6 degrees at most on *STATIC.')
      call add_explanation(list, 'E0552', 'points touch one after another', &
         & 'Contact of a pair begins in this increment, its points touch at different times, '// &
         & 'and the same increment shears them. Friction reads the order. Such an increment '// &
         & 'ends where contact begins, and the rest is done in five parts; this is told in the '// &
         & 'log.', &
         & 'smaller increments on *STATIC.')
      call add_explanation(list, 'W0551', 'first touch and shear in one increment', &
         & 'Contact of a pair begins in a DIRECT increment, its points touch at different '// &
         & 'times, and the same increment shears them. Slip counts from where each point '// &
         & 'touched, but the pressures of the end stand for all of the way: forces of friction '// &
         & 'may be off by a tenth or two.', &
         & 'smaller increments on *STATIC, or leave out DIRECT.')
      call add_explanation(list, 'N0551', 'an increment was cut to follow the way', &
         & 'The motion of the increment would have jumped over a body or a tool (E0550), or a '// &
         & 'tool would have turned far below what slides on it (E0553). It was cut, and the '// &
         & 'way is followed.', &
         & 'nothing to do; a smaller first increment on *STATIC spares the trials.')
   end subroutine rate_explanations
end module lopin_explain_time
