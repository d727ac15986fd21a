!> Elements that are about to fold, named while the results can still be trusted.
module lopin_judge_mesh
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_corner_shape, only : corners_type, new_corners, worst_corner
   use lopin_scene, only : scene_type
   use lopin_say_once, only : say_once
   implicit none
   private
   public :: judge_mesh

   !> Scaled Jacobian at a corner below which it is about to fold, if deformation has taken half.
   real(wp), parameter :: about_to_fold = 0.1_wp, spoiled = 0.5_wp

contains

   !> Warn once a step of the worst corner of the accepted displacements.
   subroutine judge_mesh(scene, model, increment)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: increment
      type(corners_type) :: corners(size(scene%solids%group))
      real(wp) :: x(3, 8), least, value, before
      integer :: e, a, k, worst, node, g, corner

      do g = 1, size(corners)
         call new_corners(corners(g), scene%solids%group(g)%element%cell)
      end do
      least = about_to_fold
      worst = 0
      node = 0
      do e = 1, model%mesh%nelement
         g = scene%solids%which(e)
         if (g == 0) cycle
         do a = 1, corners(g)%n
            associate (i => model%mesh%conn(a, e))
               do k = 1, model%mesh%ndim
                  x(k, a) = model%mesh%x(k, i)
                  if (scene%dofs%id(k, i) > 0) x(k, a) = x(k, a) + scene%u(scene%dofs%id(k, i))
               end do
            end associate
         end do
         call worst_corner(corners(g), x, value, corner)
         if (.not. value < least) cycle
         call worst_corner(corners(g), model%mesh%x(:, model%mesh%conn(:corners(g)%n, e)), before, &
            & a)
         if (.not. value < spoiled*before) cycle
         least = value
         worst = e
         node = model%mesh%conn(corner, e)
      end do
      if (worst == 0) return
      call say_once(scene%log, 'W0531', 'element '//to_text(model%mesh%element_label(worst))// &
         & ' is about to fold at node '//to_text(model%mesh%node_label(node))//' in step '// &
         & to_text(scene%step)//', increment '//to_text(increment)//': its scaled Jacobian is '// &
         & to_text(least, 3), model%step(scene%step)%at, &
         & help='a mesh made for the deformed shape, or finer where the body turns round an edge')
   end subroutine judge_mesh
end module lopin_judge_mesh
