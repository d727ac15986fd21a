!> Explanations of the codes of friction.
module lopin_explain_friction
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: friction_explanations

contains

   subroutine friction_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0321', 'a number of friction is out of range', &
         & 'Coefficients, slopes and decays are not negative; the shear factor m and the '// &
         & 'exponent q of Norton-Hoff are between 0 and 1; alpha, TAUMAX, ELASTIC SLIP and V0 '// &
         & 'are positive.', 'see `lopin doc ''*FRICTION''` for the order of the data.')
      call add_explanation(list, 'E0322', 'a law of friction lacks its material', &
         & 'TRESCA and COULOMB-OROWAN bound the shear by a share of the yield stress of the '// &
         & 'slave: m sigma_y / sqrt 3. It is the first row of *PLASTIC. With LAW=AUTO the '// &
         & 'materials of one interaction must lead to one law.', &
         & 'add *PLASTIC to the material, or bound the shear by TAUMAX.')
      call add_explanation(list, 'E0323', 'words of *FRICTION that contradict each other', &
         & 'Some words exclude each other, as ROUGH and a law, and some need another, as a '// &
         & 'regularisation needs the slip or the speed at which it bends.', &
         & 'the message names the words.')
      call add_explanation(list, 'W0321', 'a coefficient of friction above 1', &
         & 'Coefficients run from 0 (lubricated) to 1 (dry) in forming; larger ones exist, and '// &
         & 'so do coefficients written in percent.', 'check it.')
      call add_explanation(list, 'W0322', 'a law of the speed of slip without a scale of time', &
         & 'Norton-Hoff, V0 and EXPONENTIAL DECAY need the speed of slip. A step whose *STATIC '// &
         & 'gives no period lasts 1 by default, so that the speed is what the unit of time '// &
         & 'makes of it.', 'write initial increment and period after *STATIC.')
      call bounds(list)
      call add_explanation(list, 'W0326', 'points jammed under a bound that rises steeply', &
         & 'A bound of friction that is a stress (TRESCA, CRISTESCU, NORTON-HOFF) rises as 10 '// &
         & 'p until it is reached, which is a coefficient of 10 under less pressure. A point '// &
         & 'that such a coefficient holds may have no equilibrium near the last one. Points '// &
         & 'that Newton came back to again and again, and whole pairs where no increment went '// &
         & 'on, have a bound that rises half as steeply, and half again if need be, to the '// &
         & 'end of the step. The message has the least slope, and the largest share of all '// &
         & 'bounds that was left out so (ramp in the certificate).', &
         & 'COULOMB-OROWAN, whose slope is yours; a law that allows more shear than there is '// &
         & 'pressure is seldom meant.')
      call add_explanation(list, 'W0508', 'a body would yield', &
         & 'The von Mises stress at an integration point is above the first row of *PLASTIC. '// &
         & 'The deck computes the body as elastic, by ONLY=FRICTION on *PLASTIC or by '// &
         & 'PATH=CONDENSED, so that stresses and contact pressures there are too high.', &
         & 'leave those words out, and the body flows.')
      call add_explanation(list, 'W0509', 'the stress that friction reads has not settled', &
         & 'Cristescu''s law bounds the shear by the von Mises stress at the slave, which '// &
         & 'contains that shear. The two are solved in turn; here they still change.', &
         & 'the message has the size of the change; LAW=TRESCA does not read the stress.')
      call add_explanation(list, 'N0321', 'the law that LAW=AUTO chose', &
         & 'An elastic slave rubs by Coulomb, a perfectly plastic one by Tresca, a hardening '// &
         & 'one by Cristescu, a viscoplastic one by Norton-Hoff: each with what it needs and '// &
         & 'no more.', 'write LAW= to have another one.')
   end subroutine friction_explanations

   !> Bounds of shear that do not follow the pressure.
   subroutine bounds(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0560', 'friction by area where facets touch in part', &
         & 'TRESCA, CRISTESCU, TAUMAX and NORTON-HOFF bound the shear, not the force: friction '// &
         & 'is that stress times the area of the nodes that press. Where a sheet slides over a '// &
         & 'radius it touches along a line much narrower than a facet, and one node has the '// &
         & 'area of a facet. The area is known but for one facet of those that press side by '// &
         & 'side; the work of friction of that share, beside all other, is stated from 5 % on.', &
         & 'finer facets of the slave there; or COULOMB or COULOMB-OROWAN, whose friction '// &
         & 'follows the force.')
      call add_explanation(list, 'W0327', 'points that slip are pressed lightly for their law', &
         & 'TRESCA, CRISTESCU and NORTON-HOFF allow a shear that does not fade with the '// &
         & 'pressure. It would jump from nothing where a point touches, so it rises as 10 p '// &
         & 'until it reaches what the law says, at a tenth of that as a pressure. The '// &
         & 'certificate has the share that is left out so (ramp); here it is above 2 %.', &
         & 'with a friction stress above ten times the pressure ask whether the law is meant; '// &
         & 'COULOMB-OROWAN rises by a coefficient of its own.')
   end subroutine bounds
end module lopin_explain_friction
