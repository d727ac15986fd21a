!> The laws of friction on plain arrays, for comparison with independent references.
module lopin_probes_friction
   use lopin_error, only : error_code
   use lopin_friction, only : friction_type, condition_type, law_of, law_number, &
      & regularization_of, regularization_number
   use lopin_friction_return, only : return_to_disc, regularised_traction
   use lopin_kinds, only : wp
   implicit none
   private
   public :: friction_tractions

contains

   !> Tractions and their slopes at many points.
   subroutine friction_tractions(law_word, regularization_word, data, point, answer, code)
      character(len=*), intent(in) :: law_word, regularization_word   !! of the deck
      real(wp), intent(in) :: data(:)   !! (14) mu, mu static, decay, m, alpha, q, TAUMAX, u0, v0;
                                        !! yield stress, von Mises stress, dt, speed; stiffness of
                                        !! the return [stress/length]
      real(wp), intent(in) :: point(:, :)   !! (2, n) argument >= 0 (LINEAR: trial [stress], else
                                            !! slip [length]), pressure [stress]
      real(wp), intent(out) :: answer(:, :)   !! (3, n) traction, slope in argument, in pressure
      integer, intent(out) :: code
      type(friction_type) :: law
      type(condition_type) :: at
      integer :: i

      answer = 0.0_wp
      code = error_code%usage
      law%law = law_number(law_word)
      law%regularization = regularization_number(regularization_word)
      if (law%law <= law_of%none .or. law%regularization == 0) return
      code = 0
      law%mu = data(1)
      law%mu_static = data(2)
      law%decay = data(3)
      law%m = data(4)
      law%alpha = data(5)
      law%q = data(6)
      law%tau_max = data(7)
      law%elastic_slip = data(8)
      law%v0 = data(9)
      at = condition_type(data(10), data(11), data(12), data(13))
      do i = 1, size(point, 2)
         if (law%regularization == regularization_of%linear) then
            call return_to_disc(law, point(1, i), data(14), point(2, i), at, answer(1, i), &
               & answer(2, i), answer(3, i))
         else
            call regularised_traction(law, point(1, i), point(2, i), at, answer(1, i), &
               & answer(2, i), answer(3, i))
         end if
      end do
   end subroutine friction_tractions
end module lopin_probes_friction
