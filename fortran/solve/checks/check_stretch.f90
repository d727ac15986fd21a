!> Elastic solids stretched beyond what their law is for: loads in another unit than the modulus do
!> not show in finite strain by themselves.
module lopin_check_stretch
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_dense, only : symmetric_eigen
   use lopin_stream, only : stream_type
   use lopin_flow_curve, only : flows
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   use lopin_mean_gradient, only : gradient_of
   implicit none
   private
   public :: stretched_type, measure_stretch, check_stretch

   !> Twice as long, or half.
   real(wp), parameter :: most_strain = log(2.0_wp)
   !> Displacement gradients below this do not stretch to that.
   real(wp), parameter :: little = 0.4_wp

   !> The element stretched most so far in a step; 0: none beyond.
   type :: stretched_type
      integer :: element = 0
      real(wp) :: strain = most_strain         !! |logarithm| of the stretch [-]
      real(wp) :: stretch = 1.0_wp             !! [-]
   contains
      procedure :: keep => keep_stretched
   end type stretched_type

contains

   !> To a stream or back.
   subroutine keep_stretched(self, stream)
      class(stretched_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%element)
      call stream%pass(self%strain)
      call stream%pass(self%stretch)
   end subroutine keep_stretched

   !> Look at the elements of *ELASTIC, without flow, in an accepted increment.
   subroutine measure_stretch(self, scene, model)
      type(stretched_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: f(3, 3), c(3, 3), square(3)
      integer :: e, k, status

      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         associate (material => model%material(model%section(model%mesh%section(e))%material))
            if (material%has_neo_hooke .or. flows(material%flow)) cycle
         end associate
         call gradient_of(scene, model, e, f)
         if (norm2(f) < little) cycle
         do k = 1, 3
            f(k, k) = f(k, k) + 1.0_wp
         end do
         c = matmul(transpose(f), f)
         call symmetric_eigen(c, square, status)
         if (status /= 0 .or. .not. all(square > 0.0_wp)) cycle
         k = maxloc(abs(log(square)), dim=1)
         if (0.5_wp*abs(log(square(k))) <= self%strain) cycle
         self = stretched_type(e, 0.5_wp*abs(log(square(k))), sqrt(square(k)))
      end do
   end subroutine measure_stretch

   !> Say at the end of a step what its increments stretched most; the next begins anew.
   subroutine check_stretch(self, scene, model)
      type(stretched_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%element > 0) call warn_once(scene%log, 'W0516', 'element '// &
         & to_text(model%mesh%element_label(self%element))//' is stretched to '// &
         & to_text(self%stretch, 3)//' times its length in step '// &
         & to_text(scene%step)//', and stays elastic', model%step(scene%step)%at, &
         & help='look at the units of loads, displacements and modulus; a metal has *PLASTIC, '// &
         & 'rubber *HYPERELASTIC')
      self = stretched_type()
   end subroutine check_stretch
end module lopin_check_stretch
