!> Elastic solids stretched beyond what their law is for: loads in another unit than the modulus do
!> not show in finite strain by themselves.
module lopin_check_stretch
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_dense, only : symmetric_eigen
   use lopin_flow_curve, only : flows
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   use lopin_small_displacements, only : gradient_of
   implicit none
   private
   public :: check_stretch

   !> Twice as long, or half.
   real(wp), parameter :: most_strain = log(2.0_wp)

contains

   !> Warn once a step of the element of *ELASTIC, without flow, that is stretched most.
   subroutine check_stretch(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: f(3, 3), c(3, 3), square(3), stretch, most
      integer :: e, k, status, worst

      most = most_strain
      worst = 0
      stretch = 1.0_wp
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         associate (material => model%material(model%section(model%mesh%section(e))%material))
            if (material%has_neo_hooke .or. flows(material%flow)) cycle
         end associate
         call gradient_of(scene, model, e, f)
         do k = 1, 3
            f(k, k) = f(k, k) + 1.0_wp
         end do
         c = matmul(transpose(f), f)
         call symmetric_eigen(c, square, status)
         if (status /= 0 .or. .not. all(square > 0.0_wp)) cycle
         k = maxloc(abs(log(square)), dim=1)
         if (0.5_wp*abs(log(square(k))) <= most) cycle
         most = 0.5_wp*abs(log(square(k)))
         stretch = sqrt(square(k))
         worst = e
      end do
      if (worst == 0) return
      call warn_once(scene%log, 'W0516', 'element '//to_text(model%mesh%element_label(worst))// &
         & ' is stretched to '//to_text(stretch, 3)//' times its length at the end of step '// &
         & to_text(scene%step)//', and stays elastic', model%step(scene%step)%at, &
         & help='look at the units of loads, displacements and modulus; a metal has *PLASTIC, '// &
         & 'rubber *HYPERELASTIC')
   end subroutine check_stretch
end module lopin_check_stretch
